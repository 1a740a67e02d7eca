#include "libslam/tracking/pose_uncertainty.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"
#include "tests/keyframes/drawn_map.h"

namespace slam::tracking {
namespace {

using Eigen::Matrix3d;

/// A robot that stands in the middle of a square room, of which the map has one keyframe.
class Standing : public ::testing::Test {
 protected:
  Standing() {
    keyframes::test_maps::addKeyframe(map, {}, square(), 0, -1);
    points = keyframes::pointsOf(square(), map.options());
  }
  static lidar::Scan square() {
    lidar::Scan scan = keyframes::test_maps::roundRoom(5);
    for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
      const double angle = scan.angle(i);
      scan.ranges_m[i] =
          static_cast<float>(5 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle))));
    }
    return scan;
  }
  /// One more scan, matched where it is; `noise` as carryOn() takes it.
  void stand(PoseUncertainty& uncertainty, const std::optional<Matrix3d>& noise = std::nullopt) {
    uncertainty.noteEvidence(points, {}, map.mapOf({0}, {}).fine);
    Expected expected{};
    expected.step.sigma_xy_m = 0.02, expected.step.sigma_turn_rad = 0.01;
    scanmatch::MatchResult result;
    result.posterior_information = uncertainty.toldInformation() + scanmatch::poseInformation(0.02, 0.01);
    uncertainty.carryOn(expected, result, noise);
  }
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  std::vector<scanmatch::PatchPoint> points;
};

TEST_F(Standing, AKeyframeInheritsFromTheOneThatSawTheRoomFirst) {
  PoseUncertainty uncertainty(map);
  stand(uncertainty);
  const auto inherited = uncertainty.inheritance();
  ASSERT_EQ(inherited.views.size(), 1U);
  EXPECT_EQ(inherited.views[0].keyframe, 0);
  // The match takes over nearly all of what the view errs by.
  const Matrix3d share = inherited.gain * inherited.views[0].information.matrix();
  EXPECT_GT(share(0, 0), 0.9);
  EXPECT_LE(share(0, 0), 1);
  EXPECT_GE(inherited.own.matrix()(0, 0), 0.99 * uncertainty.noise()(0, 0));
  EXPECT_DOUBLE_EQ(inherited.points_err, 1);
}

// What is taken over adds up over the scans between two keyframes, and begins anew with each.
TEST_F(Standing, WhatIsInheritedBeginsAnewWithEveryKeyframe) {
  PoseUncertainty uncertainty(map);
  stand(uncertainty);
  const double once = uncertainty.inheritance().gain(0, 0);
  stand(uncertainty);
  EXPECT_GT(uncertainty.inheritance().gain(0, 0), once);
  uncertainty.beginKeyframe(3);
  stand(uncertainty);
  EXPECT_DOUBLE_EQ(uncertainty.inheritance().gain(0, 0), once);
  uncertainty.hangOnKeyframe();
  EXPECT_DOUBLE_EQ(uncertainty.inheritance().gain(0, 0), once) << "on known ground it goes on";
  EXPECT_EQ(uncertainty.inheritance().before, 3);
}

TEST_F(Standing, WhereTheRobotIsNotNothingIsInherited) {
  PoseUncertainty uncertainty(map);
  stand(uncertainty);
  uncertainty.forgetViews();
  EXPECT_TRUE(uncertainty.inheritance().views.empty());
  EXPECT_TRUE(uncertainty.inheritance().own.isZero()) << "odometry's edge is all that is known";
}

TEST_F(Standing, WhatAMatchDoesNotTellTheMapErrsByToo) {
  PoseUncertainty uncertainty(map);
  stand(uncertainty);
  const Matrix3d told = uncertainty.noise();
  PoseUncertainty spinning(map);
  stand(spinning, Matrix3d(9 * told));
  EXPECT_NEAR(spinning.noise()(0, 0), 9 * told(0, 0), 1e-6 * told(0, 0));
  EXPECT_NEAR(spinning.inheritance().points_err, 3, 0.05);
}

}  // namespace
}  // namespace slam::tracking
