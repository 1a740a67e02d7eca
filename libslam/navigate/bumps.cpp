#include "libslam/navigate/bumps.h"

namespace slam::navigate {
namespace {

constexpr double kRemember_s = 10;

}  // namespace

void Bumps::feel(const core::Point2& p_map) {
  places_.push_back(p_map);
  left_s_.push_back(kRemember_s);
}

void Bumps::pass(double duration_s) {
  for (double& left_s : left_s_) left_s -= duration_s;
  // The oldest stand first.
  while (!left_s_.empty() && left_s_.front() <= 0) {
    left_s_.erase(left_s_.begin());
    places_.erase(places_.begin());
  }
}

}  // namespace slam::navigate
