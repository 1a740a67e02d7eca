#include "libslam/keyframes/search.h"

#include <gtest/gtest.h>

#include "libslam/keyframes/matching.h"
#include "tests/keyframes/drawn_map.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::keyframes {
namespace {

using core::kPi;
using scanmatch::PatchPoint;
using test_maps::pointAt;

TEST(Search, ThinningKeepsTheFirstPointOfEverySquare) {
  const std::vector<PatchPoint> points = {pointAt(0.15, 0.05),  pointAt(0.05, 0.15), pointAt(0.16, 0.07),
                                          pointAt(-0.05, 0.05), pointAt(0.05, 0.05), pointAt(0.05, -0.05),
                                          pointAt(-0.01, 0.01)};
  const auto kept = thinned(points, 0.1);
  ASSERT_EQ(kept.size(), 5U) << "squares beside the axes are their own";
  EXPECT_EQ(kept[0].x, points[0].x);
  EXPECT_EQ(kept[2].x, points[3].x);
  EXPECT_EQ(kept[4].y, points[5].y);
  EXPECT_TRUE(thinned({}, 0.1).empty());
}

TEST(Search, AQuestionTakesItsPointsEvenlyOfAll) {
  std::vector<PatchPoint> points;
  points.reserve(10);
  for (int i = 0; i < 10; ++i) points.push_back(pointAt(i + 0.2, 0.2));
  const auto all = searchPoints(points, 100);
  ASSERT_EQ(all.size(), 10U);
  const auto some = searchPoints(points, 4);
  ASSERT_EQ(some.size(), 4U);
  // 0, 2.5, 5 and 7.5, rounded down.
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(some[i].x, (std::vector<double>{0, 2, 5, 7})[i] + 0.2, 1e-6);
  EXPECT_TRUE(searchPoints({}, 4).empty());
}

TEST(Search, APlaceIsFollowedAsFarAsItIsCorrectedByLittle) {
  EXPECT_TRUE(isFollowed({1, 1, 0}, {1.2, 1.2, 0.05}));
  EXPECT_FALSE(isFollowed({1, 1, 0}, {1.22, 1.22, 0})) << "both axes together";
  EXPECT_FALSE(isFollowed({1, 1, 0}, {1, 1, 0.07}));
  EXPECT_FALSE(isFollowed({1, 1, 0}, {1, 1, -0.07}));
  EXPECT_TRUE(isFollowed({1, 1, kPi - 0.02}, {1, 1, -kPi + 0.02})) << "the short way round";
  EXPECT_DOUBLE_EQ(followedTo({1, 2, 3}).mean.y, 2);
}

TEST(Search, ATwinMayExplainTheMoreTheFartherAPlaceFits) {
  EXPECT_DOUBLE_EQ(twinShare(5), 0.7);
  EXPECT_DOUBLE_EQ(twinShare(10), 0.7);
  EXPECT_DOUBLE_EQ(twinShare(30), 0.9);
  EXPECT_LT(twinShare(1e6), 1);
}

TEST(Search, TheFirstOfAreNoMoreThanThereAre) {
  EXPECT_EQ(firstOf({5, 3, 9}, 2), (std::vector<int>{5, 3}));
  EXPECT_EQ(firstOf({5}, 2), (std::vector<int>{5}));
  EXPECT_TRUE(firstOf({5}, 0).empty());
}

/// A corridor along y, mapped from many places, and how unlike its neighbours the one in the middle is.
double distinctnessAmong(const std::vector<scanmatch_test::Wall>& more) {
  std::vector<scanmatch_test::Wall> walls = {{{0, -40}, {0, 40}}, {{2, -40}, {2, 40}}};
  walls.insert(walls.end(), more.begin(), more.end());
  scanmatch_test::Lidar lidar;
  lidar.noise_m = 0, lidar.max_range_m = 6;
  core::RandomStream unused(1, "unused");
  KeyframeMap map{GraphOptions{}};
  std::vector<int> all;
  for (int k = 0; k < 21; ++k) {
    const core::Pose2 T{1, 0.4 * (k - 10), kPi / 2};
    all.push_back(test_maps::addKeyframe(map, T, look(walls, T, lidar, unused), 0.4 * k, k - 1));
  }
  const auto& points = map.keyframe(10).points;
  const auto matched = map.matchFreely(points, all, map.pose(10));
  return distinctness(points, map.mapOf(all, {1, 0}), matched);
}

TEST(Search, APlaceIsDistinctByWhatEndsACorridor) {
  const double bare = distinctnessAmong({});
  EXPECT_LT(std::abs(bare), 0.02);
  EXPECT_GT(distinctnessAmong(scanmatch_test::rectangle(0, 2, 0.4, 2.5)), bare + 0.03) << "a pillar";
  EXPECT_GT(distinctnessAmong({{{0, 3}, {2, 3}}}), bare + 0.1) << "an end";
}

}  // namespace
}  // namespace slam::keyframes
