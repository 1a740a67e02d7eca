#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "libslam/posegraph/optimize.h"
#include "libslam/testing/pose_graphs.h"
#include "tests/posegraph/real_graphs.h"

namespace slam::posegraph {
namespace {

OptimizeOptions robust(const char* how) {
  OptimizeOptions options;
  options.robust = how;
  return options;
}

double rmsDistance(const PoseGraph& a, const PoseGraph& b) {
  double sum = 0;
  for (int node = 0; node < a.nodeCount(); ++node)
    sum += std::pow(core::distance(a.pose(node), b.pose(node)), 2);
  return std::sqrt(sum / a.nodeCount());
}

/// A corridor of `nodes` metres, 1 cm and 0.01 rad an edge, chained; and the corridor's end seen from its
/// start by a loop that errs by `error_m`.
PoseGraph corridor(int nodes, double error_m) {
  PoseGraph graph;
  graph.addNode({});
  graph.setFixed(0);
  Edge edge;
  edge.information.diagonal() << 1e4, 1e4, 1e4;
  edge.T_from_to = {1, 0, 0};
  for (edge.to = 1; edge.to < nodes; ++edge.to) {
    edge.from = edge.to - 1;
    graph.addNode({double(edge.to), 0, 0});
    graph.addEdge(edge);
  }
  edge.from = 0, edge.to = nodes - 1;
  edge.T_from_to = {nodes - 1 + error_m, 0, 0};
  edge.kind = EdgeKind::kLoop;
  graph.addEdge(edge);
  return graph;
}

TEST(LoopSearch, ALoopIsJudgedByWhatItCostsTheWholeGraph) {
  // 24 edges of 1 cm and the loop's own 1 cm: 25 variances of 1 cm^2, a standard deviation of 5 cm. The
  // limit, chi2 30, lies at 5.48 of them, 27.4 cm; the loop's own chi2 is then only 30 / 25.
  for (const char* how : {"local", "global"})
    for (const auto& [error_m, is_wrong] :
         {std::pair{0.26, false}, {0.29, true}, {-0.26, false}, {-0.29, true}}) {
      PoseGraph graph = corridor(25, error_m);
      const auto result = optimize(graph, robust(how));
      EXPECT_TRUE(result.converged);
      EXPECT_EQ(result.switched_off.size(), is_wrong ? 1U : 0U) << how << " " << error_m;
      EXPECT_EQ(graph.edges().back().on, !is_wrong);
      EXPECT_NEAR(graph.pose(24).x, is_wrong ? 24 : 24 + error_m * 24 / 25, 1e-6);
      EXPECT_NEAR(result.final_chi2, is_wrong ? 0 : error_m * error_m / (25 * 1e-4), 1e-6);
    }
}

TEST(LoopSearch, OdometryIsNeverSwitchedOff) {
  for (const char* how : {"local", "global"}) {
    PoseGraph graph = corridor(25, 10);
    Edge odometry = graph.edges().back();
    odometry.kind = EdgeKind::kOdometry;
    graph.addEdge(odometry);
    const auto result = optimize(graph, robust(how));
    EXPECT_THAT(result.switched_off, ::testing::Not(::testing::Contains(25)));
    EXPECT_TRUE(graph.edges()[25].on);
    EXPECT_GT(graph.pose(24).x, 30) << "though it is off by ten metres";
  }
}

TEST(LoopSearch, ALoopComesBackWhenTheGraphComesToAgree) {
  PoseGraph graph = corridor(25, 0.6);
  EXPECT_THAT(optimize(graph, robust("local")).switched_off, ::testing::ElementsAre(24));
  // Two more sightings of the end, both 0.6 m further than the odometry has it, surer than the chain.
  Edge sighting = graph.edges().back();
  sighting.on = true;
  sighting.kind = EdgeKind::kOdometry;
  graph.addEdge(sighting);
  const auto result = optimize(graph, robust("local"));
  EXPECT_TRUE(result.switched_off.empty());
  EXPECT_TRUE(graph.edges()[24].on);
}

TEST(LoopSearch, ALoopThatAloneHoldsAPartStaysOn) {
  // Two trajectories that only loops tie: three agree, one does not.
  for (const char* how : {"local", "global"}) {
    const PoseGraph one = testing::driveOnGrid(30, 1).graph;
    PoseGraph graph = one;
    graph.addNode({50, 50, 1});
    for (int node = 1; node < 10; ++node) graph.addNode({50, 50.0 + node, 1});
    Edge edge = one.edges().front();
    edge.T_from_to = {1, 0, 0};
    for (int node = 31; node < 40; ++node) {
      edge.from = node - 1, edge.to = node;
      graph.addEdge(edge);
    }
    const core::Pose2 T_map_second{5, 5, 1};
    edge.kind = EdgeKind::kLoop;
    const auto tie = [&](int from, int to, double error_m) {
      edge.from = from, edge.to = to;
      edge.T_from_to =
          core::between(one.pose(from), T_map_second * core::Pose2{double(to - 30) + error_m, 0, 0});
      return graph.addEdge(edge);
    };
    const int wrong = tie(2, 32, 7);
    for (const int node : {3, 4, 5}) tie(node, 30 + node, 0);
    auto result = optimize(graph, robust(how));
    EXPECT_TRUE(result.converged) << how;
    EXPECT_THAT(result.switched_off, ::testing::ElementsAre(wrong)) << how;
    EXPECT_LT(core::distance(graph.pose(30), T_map_second), 0.5);

    for (size_t i = 0; i < graph.edges().size(); ++i)
      if (graph.edges()[i].kind == EdgeKind::kLoop && graph.edges()[i].to >= 30)
        graph.setOn(static_cast<int>(i), static_cast<int>(i) == wrong);
    result = optimize(graph);
    EXPECT_TRUE(result.converged);
    EXPECT_TRUE(graph.edges()[static_cast<size_t>(wrong)].on);
  }
}

/// Two poses that nothing ties yet, and a loop's edge between them for the tests to fill in.
std::pair<PoseGraph, Edge> twoPoses(const core::Pose2& second) {
  std::pair<PoseGraph, Edge> result;
  result.first.addNode({});
  result.first.setFixed(0);
  result.first.addNode(second);
  result.second.from = 0, result.second.to = 1, result.second.kind = EdgeKind::kLoop;
  return result;
}

TEST(LoopSearch, OfTiesThatContradictEachOtherTheCheapestStays) {
  for (const bool first_is_stronger : {false, true}) {
    auto [graph, edge] = twoPoses({5, 0, 0});
    edge.T_from_to = {5, 0, 0};
    edge.information *= first_is_stronger ? 2e4 : 1e4;
    const int first = graph.addEdge(edge);
    edge.T_from_to = {5, 7, 0};
    edge.information *= first_is_stronger ? 0.5 : 2;
    const int second = graph.addEdge(edge);
    const auto result = optimize(graph, robust("global"));
    EXPECT_THAT(result.switched_off, ::testing::ElementsAre(first_is_stronger ? second : first));
  }
}

TEST(LoopSearch, TheOnlyTieIsNotJudged) {
  for (const char* how : {"local", "global"}) {
    auto [graph, edge] = twoPoses({5, 5, 1});
    edge.T_from_to = {1, 0, 0};
    edge.information *= 1e6;
    graph.addEdge(edge);
    const auto result = optimize(graph, robust(how));
    EXPECT_TRUE(result.switched_off.empty()) << how;
    EXPECT_NEAR(graph.pose(1).x, 1, 1e-6);
  }
}

TEST(LoopSearch, TheMedianLoopSetsTheScaleWhereInformationIsTooModest) {
  // All information a hundredth of what is right: a wrong loop, 0.7 m off, costs at most 12.
  int caught = 0, caught_without = 0;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    PoseGraph graph;
    const auto driven = testing::driveOnGrid(200, seed);
    for (const core::Pose2& pose : driven.graph.poses()) graph.addNode(pose);
    graph.setFixed(0);
    for (Edge edge : driven.graph.edges()) {
      edge.information *= 0.01;
      graph.addEdge(edge);
    }
    // Beside the last true loop, whose ends know of each other.
    Edge wrong;
    for (const Edge& edge : graph.edges())
      if (edge.kind == EdgeKind::kLoop) wrong = edge;
    wrong.T_from_to = wrong.T_from_to * core::Pose2{0.7, 0, 0};
    const int number = graph.addEdge(wrong);
    OptimizeOptions options = robust("global");
    PoseGraph with = graph;
    caught += optimize(with, options).switched_off == std::vector<int>{number};
    options.switch_off_medians = 0;
    caught_without += optimize(graph, options).switched_off == std::vector<int>{number};
  }
  EXPECT_EQ(caught, 5);
  EXPECT_EQ(caught_without, 0);
}

/// Adds false loops to a graph and compares with the optimum without them.
void expectCleanSolution(const PoseGraph& graph, double share, std::uint64_t seed, const char* how) {
  PoseGraph clean = graph, dirty = graph;
  const double clean_chi2 = optimize(clean).final_chi2;
  core::RandomStream random(seed, "false loops");
  ASSERT_GT(testing::addFalseLoops(dirty, share, random), 0);
  const auto result = optimize(dirty, robust(how));
  EXPECT_TRUE(result.converged) << how << " " << seed;
  double true_chi2 = 0;
  for (size_t i = 0; i < graph.edges().size(); ++i) true_chi2 += dirty.chi2(static_cast<int>(i));
  EXPECT_LT(true_chi2, 1.05 * clean_chi2) << how << " " << seed;
  // Of some thirty metres of map.
  EXPECT_LT(rmsDistance(clean, dirty), 0.05) << how << " " << seed;
}

TEST(LoopSearch, FindsTheSolutionAmongFalseLoops) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const PoseGraph graph = testing::driveOnGrid(300, seed).graph;
    expectCleanSolution(graph, 0.1, seed, "local");
    expectCleanSolution(graph, 0.1, seed, "global");
    expectCleanSolution(graph, 1, seed, "global");
  }
}

TEST(LoopSearch, CleanGraphsKeepTheirLoops) {
  for (const char* how : {"local", "global"})
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      PoseGraph graph = testing::driveOnGrid(200, seed).graph, plain = graph;
      optimize(plain);
      EXPECT_TRUE(optimize(graph, robust(how)).switched_off.empty()) << how << " " << seed;
      EXPECT_LT(rmsDistance(graph, plain), 1e-6);
    }
}

TEST(LoopSearch, IntelWithATenthOfItsLoopsFalseEndsAtTheCleanSolution) {
  const auto graph = realGraph("intel");
  if (!graph) GTEST_SKIP() << "no posegraphs/intel.g2o.xz";
  for (std::uint64_t seed = 0; seed < 3; ++seed) expectCleanSolution(*graph, 0.1, seed, "global");
}

TEST(LoopSearch, ManhattanWithATenthOfItsLoopsFalseEndsAtTheCleanSolution) {
  const auto graph = realGraph("manhattan");
  if (!graph) GTEST_SKIP() << "no posegraphs/manhattan.g2o.xz";
  for (std::uint64_t seed = 0; seed < 3; ++seed) expectCleanSolution(*graph, 0.1, seed, "global");
}

}  // namespace
}  // namespace slam::posegraph
