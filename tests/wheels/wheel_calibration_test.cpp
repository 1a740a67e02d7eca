#include "libslam/wheels/wheel_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace slam::wheels {
namespace {

WheelCalibration afterDriving(int steps) {
  WheelCalibration wheels(Told::kByAll);
  for (int i = 0; i < steps; ++i) {
    // Metres 4 % too short, and 0.05 rad to the right on each.
    const core::Pose2 step = wheels.corrected({0.576, 0, -0.03});
    wheels.learn(step, {0.6, 0, 0}, 1, 1);
  }
  return wheels;
}

TEST(WheelCalibration, SetsMetresAndTurnsRightTogether) {
  const core::Pose2 step = afterDriving(200).corrected({0.576, 0, -0.03});
  EXPECT_NEAR(core::hypot(step.x, step.y), 0.6, 2e-3);
  EXPECT_NEAR(step.phi, 0, 1e-3);
  EXPECT_LT(afterDriving(200).sigmaTurn_rad({1, 0, 0}),
            WheelCalibration(Told::kByAll).sigmaTurn_rad({1, 0, 0}));
}

TEST(WheelCalibration, NothingIsLearntOfStepsThatAreNotFinite) {
  WheelCalibration wheels = afterDriving(20);
  const core::Pose2 before = wheels.corrected({1, 0, 0});
  const double infinite = std::numeric_limits<double>::infinity();
  for (const core::Pose2& bad :
       {core::Pose2{infinite, 0, 0}, core::Pose2{0, 0, infinite}, core::Pose2{std::nan(""), 0, 0}}) {
    wheels.learn({0.6, 0, 0}, bad, 1, 1);
    wheels.learn(bad, {0.6, 0, 0}, 1, 1);
  }
  const core::Pose2 after = wheels.corrected({1, 0, 0});
  EXPECT_EQ(before.x, after.x);
  EXPECT_EQ(before.phi, after.phi);
}

}  // namespace
}  // namespace slam::wheels
