#include "libslam/particles/motion.h"

#include <gtest/gtest.h>

namespace slam::particles {
namespace {

core::Pose2 shifted(const core::Pose2& T, int axis, double by) {
  core::Pose2 result = T;
  (axis == 0 ? result.x : axis == 1 ? result.y : result.phi) += by;
  return result;
}

// The covariance to first order, with derivatives by differences.
TEST(Motion, TwoAfterOneAnotherHaveTheCovarianceOfTheirComposition) {
  Motion first{{0.7, -0.2, 0.6}, {}}, second{{1.3, 0.4, -0.3}, {}};
  first.covariance << 0.04, 0.01, 0.002, 0.01, 0.09, -0.003, 0.002, -0.003, 0.01;
  second.covariance << 0.02, -0.004, 0.001, -0.004, 0.05, 0.002, 0.001, 0.002, 0.03;
  Eigen::Matrix3d by_first, by_second;
  const double step = 1e-6;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_first : {true, false}) {
      const auto moved = [&](double by) {
        return is_first ? shifted(first.T_previous_robot, axis, by) * second.T_previous_robot
                        : first.T_previous_robot * shifted(second.T_previous_robot, axis, by);
      };
      const core::Pose2 up = moved(step), down = moved(-step);
      (is_first ? by_first : by_second).col(axis) =
          Eigen::Vector3d(up.x - down.x, up.y - down.y, up.phi - down.phi) / (2 * step);
    }
  const Eigen::Matrix3d expected = by_first * first.covariance * by_first.transpose() +
                                   by_second * second.covariance * by_second.transpose();
  const Motion both = first * second;
  EXPECT_TRUE(both.covariance.isApprox(expected, 1e-7)) << both.covariance << "\n\n" << expected;
  const core::Pose2 T = first.T_previous_robot * second.T_previous_robot;
  EXPECT_EQ(both.T_previous_robot.x, T.x);
  EXPECT_EQ(both.T_previous_robot.phi, T.phi);
}

// Turned by a right angle: what was uncertain ahead is uncertain sideways, and the turn's error shows where
// the way ends.
TEST(Motion, AnErrorOfTheTurnShowsAcrossTheWayAfterIt) {
  const Motion turn{{0, 0, core::kPi / 2}, Eigen::Vector3d(0, 0, 0.01).asDiagonal()};
  const Motion ahead{{2, 0, 0}, Eigen::Vector3d(0.25, 0, 0).asDiagonal()};
  const Eigen::Matrix3d covariance = (turn * ahead).covariance;
  EXPECT_NEAR(covariance(0, 0), 4 * 0.01, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 0.25, 1e-12);
  EXPECT_NEAR(covariance(0, 2), -2 * 0.01, 1e-12);
}

}  // namespace
}  // namespace slam::particles
