#include "libslam/wheels/silence.h"

#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::wheels {
namespace {

/// Matches of a robot that stands scatter by less.
constexpr double kMoved_m = 0.3, kMoved_rad = 0.3;

}  // namespace

bool Silence::take(const core::Pose2& T) {
  spoke_ = spoke_ || T.x != 0 || T.y != 0 || T.phi != 0;
  return !spoke_;
}

bool Silence::note(const core::Pose2& T_matched) {
  if (spoke_ || is_noted_) return false;
  T_first_robot_ = T_first_robot_ * T_matched;
  is_noted_ =
      core::hypot(T_first_robot_.x, T_first_robot_.y) > kMoved_m || std::abs(T_first_robot_.phi) > kMoved_rad;
  return is_noted_;
}

}  // namespace slam::wheels
