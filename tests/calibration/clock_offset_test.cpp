#include "libslam/calibration/clock_offset.h"

#include <gtest/gtest.h>

#include "tests/calibration/drawn_motion.h"

namespace slam::calibration {
namespace {

using test_motion::driven;
using test_motion::kWheels;
using test_motion::Robot;

ClockOffset offsetOf(double clock_s, double noise_rad = 0.005) {
  Robot robot;
  robot.clock_s = clock_s, robot.noise_rad = noise_rad;
  return findClockOffset({driven(robot, 800)}, kWheels);
}

TEST(ClockOffset, IsWhatHasToBeAddedToTheOdometrysStamps) {
  for (const double offset_s : {-1.3, -0.42, 0.0, 0.1, 0.77, 2.0}) {
    const auto found = offsetOf(-offset_s);
    ASSERT_TRUE(found.is_observable) << offset_s;
    // A fraction of the period of 0.1 s, in which turns are constant.
    EXPECT_NEAR(found.offset_s.value, offset_s, 0.015);
    EXPECT_LE(found.offset_s.low, found.offset_s.value);
    EXPECT_GE(found.offset_s.high, found.offset_s.value);
    EXPECT_LT(found.offset_s.distanceTo(offset_s), 0.015);
    EXPECT_GT(found.correlation, 0.9);
    if (std::abs(offset_s) > 0.5) {
      EXPECT_LT(found.correlation_at_zero, 0.8);
    }
  }
  EXPECT_NEAR(offsetOf(0).correlation_at_zero, offsetOf(0).correlation, 0.01);
}

TEST(ClockOffset, CannotBeSeenBeyondItsReachOrWithoutTurns) {
  EXPECT_FALSE(offsetOf(4).is_observable) << "4 s are more than 3";
  const auto straight = findClockOffset({driven({}, 800, 0)}, kWheels);
  EXPECT_FALSE(straight.is_observable);
  EXPECT_LT(straight.turned_rad, 2);
  // Turns of the scans that have nothing to do with the odometry's.
  EXPECT_FALSE(offsetOf(0, 0.5).is_observable);
  EXPECT_FALSE(findClockOffset({}, kWheels).is_observable);
  EXPECT_FALSE(findClockOffset({driven({}, 800)}, "another stream").is_observable);
}

TEST(ClockOffset, StretchesCountTogetherAndMismatchesNot) {
  Robot robot;
  robot.clock_s = -0.3;
  auto first = driven(robot, 400);
  for (std::size_t k = 0; k < first.steps.size(); k += 7) {
    first.steps[k].T_previous_lidar.phi = 3;  // a turn that no scan matching follows
    if (k % 2 == 0) first.steps[k].T_previous_lidar.phi = -0.5, first.steps[k].is_matched = false;
  }
  const auto found = findClockOffset({first, driven(robot, 400)}, kWheels);
  ASSERT_TRUE(found.is_observable);
  EXPECT_NEAR(found.offset_s.value, 0.3, 0.015);
}

}  // namespace
}  // namespace slam::calibration
