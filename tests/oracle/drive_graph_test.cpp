#include "libslam/oracle/drive_graph.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/oracle/views.h"
#include "tests/world/drawn_plan.h"

namespace slam::oracle {
namespace {

using Node = DriveGraph::Node;

/// 0.1 m cells, walled in; a wall across from the bottom up to a gap below the top, 40 cells from the left.
world::Plan hall(int columns, int rows, int wall_at = -1, int gap = 0) {
  std::vector<std::string> lines(static_cast<size_t>(rows),
                                 "#" + std::string(static_cast<size_t>(columns - 2), '.') + "#");
  lines.front() = lines.back() = std::string(static_cast<size_t>(columns), '#');
  if (wall_at > 0)
    for (size_t row = static_cast<size_t>(gap) + 1; row < lines.size(); ++row)
      lines[row][static_cast<size_t>(wall_at)] = '#';
  return world::drawnPlan(lines, 0.1);
}

/// The node of the block at a place.
Node nodeAt(const DriveGraph& graph, const world::Plan& plan, double x, double y) {
  const auto cell = world::pointToCells(plan, {x, y});
  return graph.nodeAt(static_cast<size_t>(cell.y) * static_cast<size_t>(plan.columns) +
                      static_cast<size_t>(cell.x));
}

double along(const DriveGraph& graph, const std::vector<Node>& way) {
  double length_m = 0;
  for (size_t i = 1; i < way.size(); ++i) {
    length_m += core::distance(graph.pointOf(way[i - 1]), graph.pointOf(way[i]));
    EXPECT_TRUE(graph.seesStraight(graph.pointOf(way[i - 1]), graph.pointOf(way[i]))) << i;
  }
  return length_m;
}

// 2.7 % is what moves of a king and a knight are longer than straight ones, at most; and nodes lie a cell
// aside.
TEST(DriveGraph, WaysAcrossAHallAreNearlyStraight) {
  const auto plan = hall(80, 60);
  const DriveGraph graph(plan, {1.05, 1.05}, 0.25, 4);
  const auto ways = graph.waysFrom(0);
  ASSERT_GT(graph.size(), 200U);
  for (Node node = 0; node < static_cast<Node>(graph.size()); ++node) {
    const double straight_m = core::distance(graph.pointOf(0), graph.pointOf(node)),
                 way_m = static_cast<double>(ways.length_m[static_cast<size_t>(node)]);
    EXPECT_GE(way_m, straight_m - 1e-4);
    EXPECT_LE(way_m, 1.028 * straight_m + 0.2) << node;
  }
}

TEST(DriveGraph, BeginsAtTheStartsOwnCell) {
  const auto plan = hall(40, 40);
  const DriveGraph graph(plan, {1.23, 2.71}, 0.2, 5);
  EXPECT_EQ(graph.cellOf(0), 27U * 40U + 12U);
  EXPECT_NEAR(graph.pointOf(0).x, 1.25, 1e-9);
  EXPECT_NEAR(graph.pointOf(0).y, 2.75, 1e-9);
  EXPECT_EQ(graph.nodeAt(graph.cellOf(0)), 0);
  // Other nodes are at the middle of their block: cells 20 to 24, 30 to 34.
  const Node other = nodeAt(graph, plan, 2.45, 3.05);
  EXPECT_EQ(graph.cellOf(other), 32U * 40U + 22U);
}

TEST(DriveGraph, AWayLeadsRoundAWallByItsNodes) {
  const auto plan = hall(80, 60, 40, 8);
  const DriveGraph graph(plan, {3.05, 1.05}, 0.25, 3);
  const Node beyond = nodeAt(graph, plan, 5, 1);
  ASSERT_GE(beyond, 0);
  const auto ways = graph.waysFrom(0);
  const auto way = graph.way(ways, beyond);
  EXPECT_EQ(way.front(), 0);
  EXPECT_EQ(way.back(), beyond);
  EXPECT_NEAR(along(graph, way), static_cast<double>(ways.length_m[static_cast<size_t>(beyond)]), 1e-3);
  // The wall ends at 5.1 m and its rim keeps the disc off by 0.25 m: up, across and down again.
  const core::Point2 from = graph.pointOf(0), to = graph.pointOf(beyond);
  const double round_m = core::distance(from, {4.0, 5.3}) + core::distance({4.1, 5.3}, to);
  EXPECT_GT(along(graph, way), round_m);
  // The moves' 2.8 %, and at each of two bends the raster of 0.3 m.
  EXPECT_LT(along(graph, way), 1.028 * round_m + 0.6);
  EXPECT_FALSE(graph.seesStraight({3, 1}, {5, 1}));
  EXPECT_TRUE(graph.seesStraight({3, 1}, {3, 5}));
  EXPECT_FALSE(graph.seesStraight({3, 1}, {30, 1})) << "outside of the plan";
  EXPECT_EQ(graph.way(ways, 0), std::vector<Node>{0});
}

TEST(DriveGraph, WhereTheDiscDoesNotFitNoWayLeads) {
  const auto plan = hall(80, 60, 40, 8);
  const DriveGraph thin(plan, {3.05, 1.05}, 0.25, 3), wide(plan, {3.05, 1.05}, 0.45, 3);
  EXPECT_GE(nodeAt(thin, plan, 6, 3), 0);
  EXPECT_EQ(nodeAt(wide, plan, 6, 3), -1) << "the gap is 0.8 m wide";
  EXPECT_EQ(nodeAt(wide, plan, 0.2, 3), -1) << "too near to a wall";
  for (size_t cell = 0; cell < plan.cells.size(); ++cell)
    EXPECT_FALSE(wide.isReachable(cell) && cell % 80 >= 40) << cell;
  EXPECT_EQ(DriveGraph(plan, {4.05, 1}, 0.2, 3).size(), 0U) << "a start in the wall";
  EXPECT_EQ(DriveGraph(plan, {-3, 1}, 0.2, 3).size(), 0U);
  EXPECT_EQ(DriveGraph(plan, {30, 1}, 0.2, 3).size(), 0U);
}

TEST(DriveGraph, WaysEndWhereSomethingElseIsNearer) {
  const auto plan = hall(60, 20);
  const DriveGraph graph(plan, {1.05, 1.05}, 0.25, 3);
  const auto all = graph.waysFrom(0);
  std::vector<float> below(graph.size(), 2.0F);
  const auto near = graph.waysFrom(0, below);
  for (size_t node = 1; node < graph.size(); ++node) {
    if (all.length_m[node] < 2) {
      EXPECT_FLOAT_EQ(near.length_m[node], all.length_m[node]);
    } else {
      EXPECT_TRUE(std::isinf(near.length_m[node]));
    }
  }
}

TEST(DriveGraph, BlocksAreTheSmallestThatAreFewEnough) {
  const auto plan = hall(100, 100);
  EXPECT_EQ(DriveGraph::blockFor(plan, 1000000), 2) << "never a node for each cell";
  EXPECT_EQ(DriveGraph::blockFor(plan, 1000), 4);
  EXPECT_EQ(DriveGraph::blockFor(plan, 400), 5);
  EXPECT_EQ(DriveGraph::blockFor(plan, 399), 6);
}

/// Views in the hall with a wall, as far as a lidar sees.
struct Seen {
  world::Plan plan = hall(80, 60, 40, 8);
  core::Point2 start{3.05, 1.05};
  DriveGraph graph{plan, start, 0.25, 3};
  metrics::ExplorableArea area;
  Views views;
  explicit Seen(double range_m, double spacing_m = 1)
      : area(metrics::explorableArea(plan, start, 0.25, range_m)) {
    ViewOptions options;
    options.max_range_m = range_m, options.spacing_m = spacing_m;
    views = sampleViews(plan, area, graph, options);
  }
};

TEST(Views, SpreadOverAllThatCanBeDriven) {
  const Seen seen(0, 1);
  const Views& views = seen.views;
  ASSERT_GT(views.node.size(), 20U);
  EXPECT_EQ(views.node.front(), 0);
  EXPECT_EQ(views.seen.size(), views.node.size());
  std::vector<std::vector<float>> ways;
  for (const Node node : views.node) ways.push_back(seen.graph.waysFrom(node).length_m);
  // Each is a metre and more from those before it; every node is nearer than that to one, and knows which.
  for (size_t a = 0; a < views.node.size(); ++a)
    for (size_t b = 0; b < a; ++b)
      EXPECT_GE(ways[a][static_cast<size_t>(views.node[b])], 1.0F - 1e-4F) << a << " " << b;
  for (size_t node = 0; node < seen.graph.size(); ++node) {
    float nearest_m = 1e9F;
    for (const auto& way : ways) nearest_m = std::min(nearest_m, way[node]);
    EXPECT_LT(nearest_m, 1.0F);
    EXPECT_NEAR(ways[static_cast<size_t>(views.near[node])][node], nearest_m, 1e-4F) << node;
  }
}

TEST(Views, TogetherSeeAllThatCanBeExplored) {
  for (const double range_m : {0.0, 2.0}) {
    const Seen seen(range_m, 100);  // the start's alone, and what it does not see
    SampleSet all(seen.views.seen.front().size(), 0);
    for (const auto& one : seen.views.seen)
      for (size_t w = 0; w < all.size(); ++w) all[w] |= one[w];
    EXPECT_GT(seen.views.node.size(), 1U);
    // But for a few at the very end of the range: the node is not in the middle of the cell that sees them.
    EXPECT_GE(countOf(all) * 1000, seen.views.samples * 999) << range_m;
    EXPECT_EQ(seen.views.samples, seen.area.cells) << "there are fewer cells than samples";
    // From the start nothing beyond the wall is seen, and only what is within the range.
    const double sees = static_cast<double>(countOf(seen.views.seen.front()));
    const double most =
        range_m > 0 ? 100 * core::kPi * range_m * range_m : 0.75 * static_cast<double>(seen.views.samples);
    EXPECT_LT(sees, most);
    EXPECT_GT(sees * 0.01, 5);
  }
  EXPECT_EQ(countOf({0b1011, ~std::uint64_t{0}}), 67U);
}

}  // namespace
}  // namespace slam::oracle
