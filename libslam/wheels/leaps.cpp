#include "libslam/wheels/leaps.h"

#include <algorithm>

#include "libslam/core/elementary.h"

namespace slam::wheels {
namespace {

constexpr double kShared_m = 4, kFastest_mps = 3;
/// A leap is so much faster than the wheels were before.
constexpr double kFaster = 3;

}  // namespace

bool Leaps::take(const core::Pose2& T_wheels, double since_s) {
  const double way_m = core::hypot(T_wheels.x, T_wheels.y), speed_mps = way_m / since_s;
  if (!(since_s > 0) || !(speed_mps >= 0)) return false;
  const bool is_leap =
      !leapt_ && way_m > kShared_m && speed_mps > std::max(kFastest_mps, kFaster * fastest_mps_);
  if (!is_leap) fastest_mps_ = std::max(fastest_mps_, speed_mps);
  leapt_ = is_leap;
  return is_leap;
}

}  // namespace slam::wheels
