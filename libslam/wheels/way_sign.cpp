#include "libslam/wheels/way_sign.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/wheels/pieces.h"

namespace slam::wheels {
namespace {

/// As if so many metres had been driven before, one of them the other way: nobody knows the robot.
constexpr double kBefore_m = 2.7, kReversedBefore_m = 1;
/// A metre that was counted backwards, and was one, speaks for the sign as so many speak against it that were
/// not. A metre forwards says little: the robot may never have driven backwards before.
constexpr double kCountedBackwards = 10, kCountedForwards = 0.1;
/// A match is of a step that went as counted, or the other way, when it lies nearer to that than this share
/// of the step.
constexpr double kNear = 0.5;

}  // namespace

void WaySign::learn(const core::Pose2& T_wheels, const core::Pose2& T_matched, double told) {
  const double way_m = core::hypot(T_wheels.x, T_wheels.y);
  if (!(told >= kTold) || !(way_m > 0) || !(way_m < kMostStep_m)) return;
  const double near_m = kNear * way_m;
  if (core::hypot(T_matched.x - T_wheels.x, T_matched.y - T_wheels.y) < near_m)
    signed_m_ += (T_wheels.x < 0 ? kCountedBackwards : kCountedForwards) * way_m;
  if (core::hypot(T_matched.x + T_wheels.x, T_matched.y + T_wheels.y) < near_m) reversed_m_ += way_m;
}

double WaySign::against() const {
  return core::log((kBefore_m + signed_m_ + reversed_m_) / (kReversedBefore_m + reversed_m_));
}

}  // namespace slam::wheels
