#include "libslam/keyframes/links.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/random.h"

namespace slam::keyframes {
namespace {

using Pairs = std::vector<std::pair<double, int>>;

std::vector<int> numbersOf(const Pairs& near) {
  std::vector<int> numbers;
  for (const auto& one : near) numbers.push_back(one.second);
  return numbers;
}

/// Keyframes a metre apart along x, each linked with the next.
struct Row {
  std::vector<core::Pose2> poses;
  Links links;
  explicit Row(int count) {
    for (int k = 0; k < count; ++k) poses.push_back({1.0 * k, 0, 0}), links.addKeyframe();
    for (int k = 1; k < count; ++k) links.join(k - 1, k, 1);
  }
};

TEST(Links, ReachAsFarAsTheirPathAndNameTheNearestToTheCentreFirst) {
  const Row row(6);
  // From keyframe 0, two metres of links; nearest to x = 1.9.
  const auto near = row.links.around(row.poses, 0, {1.9, 0}, 2, 10);
  EXPECT_EQ(numbersOf(near), (std::vector<int>{2, 1, 0}));
  EXPECT_NEAR(near[0].first, 0.01, 1e-12);  // squared distances
  EXPECT_NEAR(near[2].first, 3.61, 1e-12);
  EXPECT_EQ(numbersOf(row.links.around(row.poses, 0, {0, 0}, 1.99, 10)), (std::vector<int>{0, 1}));
  // Within the circle, however far the path may be.
  EXPECT_EQ(numbersOf(row.links.around(row.poses, 0, {0, 0}, 100, 3)), (std::vector<int>{0, 1, 2, 3}));
}

TEST(Links, NameAllWithinTheirPathWhereverTheyAre) {
  const Row row(6);
  const auto linked = [&](int start, double path_m) {
    auto numbers = row.links.linkedWith(start, path_m);
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  };
  EXPECT_EQ(linked(4, 1), (std::vector<int>{3, 4, 5}));
  EXPECT_EQ(linked(4, 0.9), (std::vector<int>{4}));
  EXPECT_EQ(linked(0, 100), (std::vector<int>{0, 1, 2, 3, 4, 5}));
}

TEST(Links, TakeTheShorterOfTwoChainsWhicheverIsFoundFirst) {
  Links links;
  for (int k = 0; k < 4; ++k) links.addKeyframe();
  const std::vector<core::Pose2> poses = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  links.join(0, 1, 5);
  links.join(0, 2, 1), links.join(2, 1, 1), links.join(1, 3, 1);
  EXPECT_EQ(links.around(poses, 0, {0, 0}, 3, 10).size(), 4U);
  EXPECT_EQ(links.around(poses, 0, {0, 0}, 2.9, 10).size(), 3U);
  // Links hold both ways.
  EXPECT_EQ(links.around(poses, 3, {0, 0}, 3, 10).size(), 4U);
}

TEST(Links, ChainsMayLeaveTheCircleByHalfItsRadius) {
  Links links;
  for (int k = 0; k < 3; ++k) links.addKeyframe();
  links.join(0, 1, 1), links.join(1, 2, 1);
  const auto roundBy = [&](double x) {
    const std::vector<core::Pose2> poses = {{0, 0, 0}, {x, 0, 0}, {0, 1, 0}};
    return numbersOf(links.around(poses, 0, {0, 0}, 100, 2));
  };
  EXPECT_EQ(roundBy(2.9), (std::vector<int>{0, 2}));
  EXPECT_EQ(roundBy(3.1), (std::vector<int>{0}));
}

TEST(Links, AnswersDoNotDependOnWhatWasAskedBefore) {
  const Row row(8);
  const auto wide = row.links.around(row.poses, 4, {4, 0}, 3, 10);
  row.links.around(row.poses, 0, {0, 0}, 100, 100);
  row.links.around(row.poses, 7, {7, 0}, 1, 100);
  EXPECT_EQ(row.links.around(row.poses, 4, {4, 0}, 3, 10), wide);
  // And keyframes that come later are known.
  Row growing(2);
  growing.links.around(growing.poses, 0, {0, 0}, 10, 10);
  growing.links.addKeyframe(), growing.poses.push_back({2, 0, 0});
  growing.links.join(1, 2, 1);
  EXPECT_EQ(growing.links.around(growing.poses, 0, {0, 0}, 10, 10).size(), 3U);
}

TEST(Links, LengthsAreTakenAnewWhenKeyframesHaveMoved) {
  Row row(4);
  for (int k = 0; k < 4; ++k) row.poses[static_cast<size_t>(k)] = {0, 3.0 * k, 1};
  EXPECT_EQ(row.links.around(row.poses, 0, {0, 0}, 3, 100).size(), 4U);
  row.links.measure(row.poses);
  EXPECT_EQ(row.links.around(row.poses, 0, {0, 0}, 3, 100).size(), 2U);
  EXPECT_EQ(row.links.around(row.poses, 3, {0, 0}, 6, 100).size(), 3U);
}

TEST(Links, GoOnByTheNearestWhereAKeyframeIsTakenOut) {
  Links links;
  std::vector<core::Pose2> poses;
  for (int k = 0; k < 6; ++k) poses.push_back({1.0 * k, 0, 0}), links.addKeyframe();
  for (int k = 1; k < 6; ++k) links.join(k - 1, k, 1);
  ASSERT_EQ(links.around(poses, 0, {0, 0}, 10, 10).size(), 6U);
  links.remove(3);
  const auto reached = links.around(poses, 0, {0, 0}, 10, 10);
  ASSERT_EQ(reached.size(), 5U);
  EXPECT_EQ(reached.back().second, 5);
  // As long as it was: five metres to the last one.
  EXPECT_EQ(links.around(poses, 0, {0, 0}, 4.9, 10).size(), 4U);
  EXPECT_EQ(links.around(poses, 0, {0, 0}, 5.1, 10).size(), 5U);
}

TEST(Links, OfAStarWhoseMiddleIsTakenOutTheNearestBecomesTheMiddle) {
  Links links;
  const std::vector<core::Pose2> poses(4);
  for (int k = 0; k < 4; ++k) links.addKeyframe();
  links.join(3, 0, 2), links.join(3, 1, 1), links.join(3, 2, 4);
  links.remove(3);
  const auto reached = [&](int start, double path_m) {
    auto numbers = numbersOf(links.around(poses, start, {0, 0}, path_m, 10));
    std::sort(numbers.begin(), numbers.end());
    return numbers;
  };
  EXPECT_EQ(reached(1, 2.9), (std::vector<int>{1}));
  EXPECT_EQ(reached(1, 3), (std::vector<int>{0, 1}));
  EXPECT_EQ(reached(1, 5), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(reached(0, 7.9), (std::vector<int>{0, 1})) << "0 and 2 hang together by 1 only";
  EXPECT_EQ(reached(3, 100), (std::vector<int>{3})) << "what was taken out leads nowhere";
  links.remove(0);
  EXPECT_EQ(reached(2, 5), (std::vector<int>{1, 2}));
}

TEST(Links, WhatIsLinkedAlreadyKeepsItsLength) {
  Links links;
  const std::vector<core::Pose2> poses(3);
  for (int k = 0; k < 3; ++k) links.addKeyframe();
  links.join(0, 1, 1), links.join(1, 2, 1), links.join(0, 2, 1.5);
  links.remove(1);
  EXPECT_EQ(links.around(poses, 0, {0, 0}, 1.5, 10).size(), 2U);
  EXPECT_EQ(links.around(poses, 0, {0, 0}, 1.4, 10).size(), 1U);
}

// However many are taken out, one after the other: the rest hangs together as before, and no way gets
// shorter.
TEST(Links, NothingFallsApartWhereKeyframesAreTakenOut) {
  constexpr int kCount = 30;
  core::RandomStream random(5, "links");
  for (int trial = 0; trial < 20; ++trial) {
    Links links;
    std::vector<core::Pose2> poses;
    for (int k = 0; k < kCount; ++k) {
      poses.push_back({random.uniform(0, 10), random.uniform(0, 10), 0});
      links.addKeyframe();
      // Two heaps, each of them in one piece.
      const int before = k / 2;
      if (k > 1) links.join(k, k % 2 + 2 * static_cast<int>(random.uniform(0, before - 1e-9)), 1);
    }
    for (const int gone : {0, 1, 14, 7, 2, 3, 22}) links.remove(gone);
    for (const int start : {4, 5}) {
      auto reached = numbersOf(links.around(poses, start, {5, 5}, 1e9, 1e3));
      std::sort(reached.begin(), reached.end());
      std::vector<int> expected;
      for (int k = 0; k < kCount; ++k)
        if (k % 2 == start % 2 && k != 0 && k != 1 && k != 14 && k != 7 && k != 2 && k != 3 && k != 22)
          expected.push_back(k);
      EXPECT_EQ(reached, expected) << "trial " << trial;
    }
  }
}

TEST(Links, ReachWhatTheShortestOfAllChainsReaches) {
  core::RandomStream random(7, "chains");
  for (int drawn = 0; drawn < 20; ++drawn) {
    constexpr int kCount = 40;
    std::vector<core::Pose2> poses;
    Links links;
    std::vector<std::vector<double>> way(kCount, std::vector<double>(kCount, 1e300));
    for (size_t k = 0; k < kCount; ++k) {
      poses.push_back({random.uniform(-1, 1), random.uniform(-1, 1), 0});
      links.addKeyframe();
      way[k][k] = 0;
    }
    for (int link = 0; link < 120; ++link) {
      const auto a = static_cast<size_t>(random.uniform(0, kCount - 0.1)),
                 b = static_cast<size_t>(random.uniform(0, kCount - 0.1));
      const double length_m = random.uniform(0, 4);
      links.join(static_cast<int>(a), static_cast<int>(b), length_m);
      way[a][b] = way[b][a] = std::min(way[a][b], length_m);
    }
    for (size_t via = 0; via < kCount; ++via)
      for (size_t a = 0; a < kCount; ++a)
        for (size_t b = 0; b < kCount; ++b) way[a][b] = std::min(way[a][b], way[a][via] + way[via][b]);
    for (const double path_m : {0.0, 1.0, 3.3, 1e9}) {
      auto reached = numbersOf(links.around(poses, 0, {0, 0}, path_m, 9));
      std::sort(reached.begin(), reached.end());
      std::vector<int> expected;
      for (int k = 0; k < kCount; ++k)
        if (way[0][static_cast<size_t>(k)] <= path_m) expected.push_back(k);
      EXPECT_EQ(reached, expected) << drawn << ", " << path_m << " m";
    }
  }
}

TEST(Links, ShortestWaysByHand) {
  std::vector<double> path_m;
  for (int k = 0; k <= 20; ++k) path_m.push_back(1.0 * k);
  // No closure: as it was driven.
  const auto driven = shortestWays(path_m, {}, 20);
  ASSERT_EQ(driven.size(), 20U);
  EXPECT_DOUBLE_EQ(driven[0], 20);
  EXPECT_DOUBLE_EQ(driven[19], 1);
  // Keyframe 18 lies where 2 did: two metres to there, and from there to both sides.
  const auto closed = shortestWays(path_m, {{2, 18}}, 20);
  EXPECT_DOUBLE_EQ(closed[2], 2);
  EXPECT_DOUBLE_EQ(closed[0], 4);
  EXPECT_DOUBLE_EQ(closed[5], 5);
  EXPECT_DOUBLE_EQ(closed[10], 10) << "half way round both ways are as long";
  EXPECT_DOUBLE_EQ(closed[17], 3);
  // A closure that begins at the keyframe itself; and one in front of it, which is a way, too.
  EXPECT_DOUBLE_EQ(shortestWays(path_m, {{20, 3}}, 20)[3], 0);
  EXPECT_DOUBLE_EQ(shortestWays(path_m, {{20, 3}}, 10)[4], 6);
  EXPECT_DOUBLE_EQ(shortestWays(path_m, {{12, 3}}, 10)[4], 3);
  EXPECT_TRUE(shortestWays(path_m, {{2, 18}}, 0).empty());
}

TEST(Links, ShortestWaysAreThoseOfAllPathsThroughClosures) {
  core::RandomStream random(3, "closures");
  std::vector<double> path_m{0};
  for (int k = 1; k < 60; ++k) path_m.push_back(path_m.back() + random.uniform(0.1, 3));
  for (int closures = 0; closures < 8; ++closures) {
    std::vector<std::pair<int, int>> pairs;
    pairs.reserve(static_cast<size_t>(closures));
    for (int c = 0; c < closures; ++c)
      pairs.push_back({static_cast<int>(random.uniform(0, 59.9)), static_cast<int>(random.uniform(0, 59.9))});
    // By Bellman's rule: no edge shortens anything any more.
    std::vector<double> way(60, 1e300);
    way[50] = 0;
    for (int round = 0; round < 130; ++round) {
      for (size_t k = 1; k < 60; ++k) {
        const double step_m = path_m[k] - path_m[k - 1];
        way[k] = std::min(way[k], way[k - 1] + step_m), way[k - 1] = std::min(way[k - 1], way[k] + step_m);
      }
      for (const auto& [a, b] : pairs) {
        auto &at_a = way[static_cast<size_t>(a)], &at_b = way[static_cast<size_t>(b)];
        at_a = at_b = std::min(at_a, at_b);
      }
    }
    const auto ways = shortestWays(path_m, pairs, 50);
    ASSERT_EQ(ways.size(), 50U);
    for (size_t k = 0; k < 50; ++k) EXPECT_NEAR(ways[k], way[k], 1e-9) << closures << " closures, " << k;
  }
}

}  // namespace
}  // namespace slam::keyframes
