#include "libslam/scanmatch/correlative_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/random.h"

namespace slam::scanmatch {
namespace {

std::vector<core::Point2> chaos(int count, double size_m, std::uint64_t seed) {
  core::RandomStream chance(seed, "points");
  std::vector<core::Point2> points;
  points.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i) points.push_back({size_m * chance.uniform(), size_m * chance.uniform()});
  return points;
}

std::vector<core::Point2> seenFrom(const core::Pose2& T_map_robot, const std::vector<core::Point2>& points) {
  std::vector<core::Point2> seen;
  seen.reserve(points.size());
  for (const auto& p : points) seen.push_back(core::inverse(T_map_robot) * p);
  return seen;
}

/// Every pose of the lattice, one by one.
double bestByHand(const LikelihoodPyramid& map, const std::vector<core::Point2>& points,
                  const core::Pose2& centre, const SearchWindow& window) {
  double farthest = 1;
  for (const auto& p : points) farthest = std::max(farthest, std::hypot(p.x, p.y));
  const double turn = map.cellSize() / farthest;
  const int turns = static_cast<int>(std::ceil(window.half_phi_rad / turn));
  const int reach = static_cast<int>(std::ceil(window.half_xy_m / map.cellSize()));
  int best = 0;
  for (int t = -turns; t <= turns; ++t) {
    const double c = std::cos(centre.phi + t * turn), s = std::sin(centre.phi + t * turn);
    for (int row = -reach; row <= reach; ++row)
      for (int column = -reach; column <= reach; ++column) {
        const core::Point2 at{centre.x + column * map.cellSize(), centre.y + row * map.cellSize()};
        if (core::distance(at, window.not_at) < window.apart_m) continue;
        int sum = 0;
        for (const auto& p : points)
          sum += map.value(
              0,
              static_cast<int>(std::floor((centre.x + c * p.x - s * p.y - map.origin().x) / map.cellSize())) +
                  column,
              static_cast<int>(std::floor((centre.y + s * p.x + c * p.y - map.origin().y) / map.cellSize())) +
                  row);
        best = std::max(best, sum);
      }
  }
  return best / (255.0 * static_cast<double>(points.size()));
}

TEST(CorrelativeSearch, FindsWhereThePointsWereSeen) {
  const auto map_points = chaos(80, 12, 1);
  const LikelihoodPyramid map(map_points, 0.1, 0.12, 6);
  const core::Pose2 truth{4.3, 6.1, 0.7};
  const auto found = searchBest(map, seenFrom(truth, map_points), {6, 4.5, 0.5}, {3, 0.4}, 0.5);
  ASSERT_TRUE(found);
  EXPECT_LT(core::distance(found->T_map_robot, truth), 0.15);  // a cell's diagonal
  EXPECT_LT(std::abs(found->T_map_robot.phi - truth.phi), 0.02);
  EXPECT_GT(found->score, 0.6);
}

TEST(CorrelativeSearch, IsAsGoodAsTryingEveryPose) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const LikelihoodPyramid map(chaos(60, 5, seed), 0.1, 0.12, 4);
    const auto points = chaos(25, 3, seed + 100);
    const core::Pose2 centre{1, 1, 0.3 * static_cast<double>(seed)};
    const SearchWindow window{1.2, 0.2};
    const auto found = searchBest(map, points, centre, window, 0);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(found->score, bestByHand(map, points, centre, window)) << seed;
  }
}

TEST(CorrelativeSearch, FindsTheBestThatIsFarEnoughFromWhereNoneIsLookedFor) {
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const LikelihoodPyramid map(chaos(60, 5, seed), 0.1, 0.12, 4);
    const auto points = chaos(25, 3, seed + 100);
    const core::Pose2 centre{1, 1, 0.3 * static_cast<double>(seed)};
    SearchWindow window{1.2, 0.2};
    const auto best = searchBest(map, points, centre, window, 0);
    ASSERT_TRUE(best);
    window.apart_m = 0.55, window.not_at = core::position(best->T_map_robot);
    const auto other = searchBest(map, points, centre, window, 0);
    ASSERT_TRUE(other);
    EXPECT_GE(core::distance(other->T_map_robot, best->T_map_robot), 0.55) << seed;
    EXPECT_DOUBLE_EQ(other->score, bestByHand(map, points, centre, window)) << seed;
  }
}

TEST(CorrelativeSearch, FindsNothingBelowTheLeastScoreNorWithoutPoints) {
  const LikelihoodPyramid map(chaos(60, 5, 1), 0.1, 0.12, 4);
  const auto points = chaos(25, 3, 2);
  const auto best = searchBest(map, points, {1, 1, 0}, {1, 0.2}, 0);
  ASSERT_TRUE(best);
  EXPECT_TRUE(searchBest(map, points, {1, 1, 0}, {1, 0.2}, best->score));
  EXPECT_FALSE(searchBest(map, points, {1, 1, 0}, {1, 0.2}, best->score + 1e-6));
  EXPECT_FALSE(searchBest(map, {}, {1, 1, 0}, {1, 0.2}, 0));
  EXPECT_FALSE(searchBest(LikelihoodPyramid({}, 0.1, 0.12, 4), points, {1, 1, 0}, {1, 0.2}, 0.1));
}

TEST(LikelihoodPyramid, HoldsTheGreatestOfEveryWindow) {
  const LikelihoodPyramid map(chaos(40, 3, 5), 0.1, 0.12, 5);
  for (int level = 1; level < map.levels(); ++level)
    for (int row = -20; row < 40; row += 3)
      for (int column = -20; column < 40; column += 3) {
        int greatest = 0;
        for (int r = row; r < row + (1 << level); ++r)
          for (int c = column; c < column + (1 << level); ++c)
            greatest = std::max(greatest, map.value(0, c, r));
        // Windows that begin before the raster's rim may be taken for empty only if they are.
        if (column >= -(1 << (map.levels() - 1)) && row >= -(1 << (map.levels() - 1))) {
          ASSERT_EQ(map.value(level, column, row), greatest) << level << " " << column << " " << row;
        }
      }
}

TEST(CorrelativeSearch, WhatLiesBesideTheMapCountsForNothing) {
  // Of these points some are always beside the map, some come into it, and some leave it.
  const LikelihoodPyramid map(chaos(60, 5, 2), 0.1, 0.12, 4);
  auto points = chaos(25, 3, 102);
  for (const core::Point2 far : {core::Point2{9, 0}, {-7, 2}, {5.1, 0.5}, {0, 5.5}, {-2.3, 1}})
    points.push_back(far);
  for (const core::Pose2 centre : {core::Pose2{1, 1, 0.2}, {-1.5, 1, 0}, {4, 4, 1}}) {
    const SearchWindow window{1.5, 0.1};
    const auto found = searchBest(map, points, centre, window, 0);
    ASSERT_TRUE(found);
    EXPECT_DOUBLE_EQ(found->score, bestByHand(map, points, centre, window)) << centre.x;
  }
}

TEST(CorrelativeSearch, InPiecesItFindsTheSame) {
  const auto map_points = chaos(80, 12, 1);
  const LikelihoodPyramid map(map_points, 0.1, 0.12, 6);
  const auto points = seenFrom({4.3, 6.1, 0.7}, map_points);
  const core::Pose2 centre{6, 4.5, 0.5};
  const SearchWindow window{3, 0.4};
  const auto whole = searchBest(map, points, centre, window, 0.5);
  ASSERT_TRUE(whole);
  for (const double piece : {1.0, 1e5}) {
    SearchInPieces search(map, points, centre, window, 0.5);
    int pieces = 1;
    for (double work = piece; !search.advance(work); work = piece, ++pieces) {
      ASSERT_LE(work, 0) << "a piece ends when nothing is left";
      ASSERT_GT(work, -1e4) << "and soon after it";
    }
    EXPECT_GT(pieces, 5) << piece;
    const auto found = search.best();
    ASSERT_TRUE(found);
    EXPECT_EQ(found->T_map_robot.x, whole->T_map_robot.x);
    EXPECT_EQ(found->T_map_robot.y, whole->T_map_robot.y);
    EXPECT_EQ(found->T_map_robot.phi, whole->T_map_robot.phi);
    EXPECT_EQ(found->score, whole->score);
  }
  SearchInPieces nothing(map, {}, centre, window, 0);
  double work = 1;
  EXPECT_TRUE(nothing.advance(work));
  EXPECT_FALSE(nothing.best());
}

}  // namespace
}  // namespace slam::scanmatch
