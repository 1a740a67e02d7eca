#include "libslam/uncertainty/inheriting.h"

#include <gtest/gtest.h>

#include "tests/keyframes/drawn_map.h"

namespace slam::uncertainty {
namespace {

using Eigen::Matrix3d;
using keyframes::test_maps::diagonal;

TEST(Inheriting, KeepsTheViewsThatToldMostAndAddsUpFromScanToScan) {
  scanmatch::MatchEvidence evidence;
  for (int view = 0; view < 8; ++view)
    evidence.by_view.push_back({view, diagonal(view % 4 + 1, view % 4 + 1, 1)});
  evidence.by_view[2].information = diagonal(50, -10, 1);
  PoseError match{};
  match.stays = diagonal(0.5, 0.5, 0), match.gain = diagonal(0.1, 0.1, 0.1),
  match.noise = diagonal(0.002, 0.002, 0.002);
  const Matrix3d odometry = diagonal(0.04, 0.04, 0.01), still = Matrix3d::Identity();
  Inheriting inheriting;
  inheriting.carryOn(match, still, odometry);
  const auto once = inheriting.of(evidence);
  ASSERT_EQ(once.views.size(), 3U);
  EXPECT_EQ(once.views[0].keyframe, 2);
  EXPECT_EQ(once.views[0].information.matrix()(1, 1), 0) << "nothing is known less than not at all";
  EXPECT_EQ(once.views[1].keyframe, 3) << "of equals the first";
  EXPECT_EQ(once.views[2].keyframe, 7);
  EXPECT_NEAR(once.own.matrix()(0, 0), 0.25 * 0.04 + 0.002, 1e-12);
  EXPECT_NEAR(once.gain(0, 0), 0.1, 1e-12);
  inheriting.carryOn(match, still, odometry);
  const auto twice = inheriting.of(evidence);
  EXPECT_NEAR(twice.own.matrix()(0, 0), 0.25 * (0.012 + 0.04) + 0.002, 1e-12);
  EXPECT_NEAR(twice.gain(0, 0), 0.5 * 0.1 + 0.1, 1e-12);
  EXPECT_EQ(twice.before, -1);
  inheriting.begin(7);
  EXPECT_TRUE(inheriting.of({}).own.isZero());
  EXPECT_EQ(inheriting.of({}).before, 7);
}

TEST(Inheriting, WhatTheMatchDoesNotTellTheKeyframesPointsErrByToo) {
  PoseError match{};
  match.stays.setZero(), match.noise = diagonal(9, 9, 1), match.beyond = diagonal(8, 8, 0);
  Inheriting inheriting;
  EXPECT_DOUBLE_EQ(inheriting.of({}).points_err, 1);
  inheriting.carryOn(match, Matrix3d::Identity(), Matrix3d::Zero());
  EXPECT_DOUBLE_EQ(inheriting.of({}).points_err, 3);
}

}  // namespace
}  // namespace slam::uncertainty
