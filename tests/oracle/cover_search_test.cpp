#include "libslam/oracle/cover_search.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libslam/core/random.h"
#include "tests/world/drawn_plan.h"

namespace slam::oracle {
namespace {

using Node = DriveGraph::Node;
using Tour = CoverSearch::Tour;

/// A hall of 8 x 6 m with a pillar, its start in the middle, and views that see what a test says: `seen` has
/// a word for each, the first one's at the start. On the way nothing more is seen.
struct Hall {
  world::Plan plan;
  DriveGraph graph;
  Views views;

  Hall(const std::vector<core::Point2>& places, const std::vector<std::uint64_t>& seen)
      : plan(drawn()), graph(plan, {4.05, 3.05}, 0.2, 2) {
    views.node.push_back(0);
    for (const auto& p : places) {
      const auto cell = world::pointToCells(plan, p);
      views.node.push_back(graph.nodeAt(static_cast<size_t>(cell.y) * 80 + static_cast<size_t>(cell.x)));
    }
    for (const std::uint64_t word : seen) views.seen.push_back({word});
    views.near.assign(graph.size(), 0);
    views.samples = 64;
  }
  static world::Plan drawn() {
    std::vector<std::string> lines(60, "#" + std::string(78, '.') + "#");
    lines.front() = lines.back() = std::string(80, '#');
    for (size_t row = 20; row < 27; ++row) lines[row].replace(20, 8, "########");
    return world::drawnPlan(lines, 0.1);
  }
};

/// The shortest of all orders of some views that see enough.
double shortest(const CoverSearch& search, const Hall& hall, std::size_t samples) {
  double best_m = std::numeric_limits<double>::infinity();
  const auto others = hall.views.node.size() - 1;
  for (std::uint32_t chosen = 0; chosen < (1U << others); ++chosen) {
    Tour tour = {0};
    for (std::size_t v = 0; v < others; ++v)
      if (chosen >> v & 1U) tour.push_back(static_cast<std::int32_t>(v + 1));
    if (search.seenBy(tour) < samples) continue;
    do best_m = std::min(best_m, search.length(tour));
    while (std::next_permutation(tour.begin() + 1, tour.end()));
  }
  return best_m;
}

TEST(CoverSearch, FindsTheShortestTourOfAFew) {
  core::RandomStream random(11, "views");
  for (int trial = 0; trial < 6; ++trial) {
    std::vector<core::Point2> places;
    std::vector<std::uint64_t> seen{1};
    for (int v = 0; v < 6; ++v) {
      core::Point2 p{0.5 + 7 * random.uniform(), 0.5 + 2.5 * random.uniform()};
      places.push_back(p);
      std::uint64_t word = 0;
      for (int bit = 0; bit < 24; ++bit) word |= std::uint64_t{random.below(3) == 0} << bit;
      seen.push_back(word);
    }
    const Hall hall(places, seen);
    CoverSearch search(hall.graph, hall.views);
    Tour all(7);
    std::iota(all.begin(), all.end(), 0);
    const std::size_t most = search.seenBy(all);
    for (const std::size_t samples : {most, most * 9 / 10, most / 2}) {
      const Tour tour = search.search(samples, 150, [] {});
      EXPECT_EQ(tour.front(), 0);
      EXPECT_GE(search.seenBy(tour), samples);
      EXPECT_LE(search.length(tour), shortest(search, hall, samples) + 1e-3) << "trial " << trial;
    }
  }
}

// What is tried while it is warm may be longer.
TEST(CoverSearch, GivesTheShortestThatItCameBy) {
  core::RandomStream random(12, "views");
  for (int trial = 0; trial < 30; ++trial) {
    std::vector<core::Point2> places;
    std::vector<std::uint64_t> seen{1};
    for (int v = 0; v < 12; ++v) {
      places.push_back({0.5 + 7 * random.uniform(), 0.5 + 2.5 * random.uniform()});
      seen.push_back(random.below(1U << 24U) & random.below(1U << 24U));
    }
    const Hall hall(places, seen);
    CoverSearch search(hall.graph, hall.views);
    const double at_first_m = search.length(search.search(24, 0, [] {}));
    for (const int rounds : {1, 2, 3})
      EXPECT_LE(search.length(search.search(24, rounds, [] {})), at_first_m + 1e-9) << "trial " << trial;
  }
}

TEST(CoverSearch, StaysWhereAllIsSeen) {
  const Hall hall({{1, 1}, {7, 1}}, {0b111, 0b011, 0b100});
  CoverSearch search(hall.graph, hall.views);
  const Tour tour = search.search(3, 50, [] {});
  EXPECT_EQ(tour, Tour{0});
  EXPECT_EQ(search.length(tour), 0);
  ASSERT_EQ(search.path(tour).size(), 1U);
  EXPECT_NEAR(search.path(tour)[0].x, 4.05, 1e-9);
}

TEST(CoverSearch, SeesAsMuchAsCanBeSeen) {
  const Hall hall({{1, 1}, {7, 1}}, {0b001, 0b010, 0b100});
  CoverSearch search(hall.graph, hall.views);
  const Tour tour = search.search(64, 50, [] {});
  EXPECT_EQ(tour.size(), 3U);
  EXPECT_EQ(search.seenBy(tour), 3U);
  // To the nearer one first, and it ends at the other: 3 m to either side.
  EXPECT_LT(search.length(tour), 1.05 * (core::distance(core::Point2{4.05, 3.05}, core::Point2{1, 1}) + 6));
  int asked = 0;
  search.search(64, 50, [&] { ++asked; });
  EXPECT_GT(asked, 0) << "somebody may want to stop it";
}

// A view that lies on the way to another one is no stop: what is seen there counts in passing.
TEST(CoverSearch, SeesOnTheWay) {
  Hall hall({{5.5, 3}, {7, 3}}, {0b001, 0b010, 0b100});
  const auto pass = hall.graph.waysFrom(0);
  for (const Node node : hall.graph.way(pass, hall.views.node[2])) {
    const double x = hall.graph.pointOf(node).x;
    hall.views.near[static_cast<size_t>(node)] = x < 5 ? 0 : x < 6.2 ? 1 : 2;
  }
  CoverSearch search(hall.graph, hall.views);
  EXPECT_EQ(search.seenBy({0, 2}), 3U);
  EXPECT_EQ(search.seenBy({0, 1}), 2U);
  EXPECT_EQ(search.search(3, 30, [] {}), (Tour{0, 2}));
}

TEST(CoverSearch, ItsPathCutsCornersOnlyWhereTheRobotFits) {
  const Hall hall({{1, 5}, {1, 1}, {7, 5}}, {1, 2, 4, 8});
  CoverSearch search(hall.graph, hall.views);
  const Tour tour = {0, 1, 2, 3};
  const auto path = search.path(tour);
  ASSERT_GE(path.size(), 4U);
  double length_m = 0;
  for (size_t i = 1; i < path.size(); ++i) {
    EXPECT_TRUE(hall.graph.seesStraight(path[i - 1], path[i])) << i;
    length_m += core::distance(path[i - 1], path[i]);
  }
  EXPECT_LE(length_m, search.length(tour) + 1e-3);
  for (const Node node : hall.views.node)
    EXPECT_TRUE(std::any_of(path.begin(), path.end(), [&](const core::Point2& p) {
      return core::distance(p, hall.graph.pointOf(node)) < 1e-9;
    })) << "every stop is on it";
  EXPECT_LT(core::distance(path.front(), hall.graph.pointOf(0)), 1e-9);
  EXPECT_LT(core::distance(path.back(), hall.graph.pointOf(hall.views.node[3])), 1e-9);
}

}  // namespace
}  // namespace slam::oracle
