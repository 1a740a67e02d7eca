#include "libslam/posegraph/optimize.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libslam/core/error.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/pose_graphs.h"
#include "tests/posegraph/real_graphs.h"

namespace slam::posegraph {
namespace {

using core::kPi;

Edge edgeOf(int from, int to, const core::Pose2& T, double information = 1) {
  Edge edge;
  edge.from = from, edge.to = to, edge.T_from_to = T;
  edge.information *= information;
  return edge;
}

void expectPose(const core::Pose2& got, const core::Pose2& expected, double tolerance) {
  EXPECT_NEAR(got.x, expected.x, tolerance);
  EXPECT_NEAR(got.y, expected.y, tolerance);
  EXPECT_NEAR(std::remainder(got.phi - expected.phi, 2 * kPi), 0, tolerance);
}

double largestDistance(const PoseGraph& a, const PoseGraph& b) {
  double largest = 0;
  for (int node = 0; node < a.nodeCount(); ++node)
    largest = std::max(largest, core::distance(a.pose(node), b.pose(node)));
  return largest;
}

TEST(Optimize, TwoMeasurementsOfOnePoseAreWeighed) {
  PoseGraph graph;
  graph.addNode({0, 0, 0});
  graph.addNode({7, -3, 2});
  graph.setFixed(0);
  graph.addEdge(edgeOf(0, 1, {1, 0, 0}, 3));
  graph.addEdge(edgeOf(0, 1, {2, 4, 0}, 1));
  const auto result = optimize(graph);
  EXPECT_TRUE(result.converged);
  expectPose(graph.pose(0), {0, 0, 0}, 0);
  expectPose(graph.pose(1), {1.25, 1, 0}, 1e-9);
  // 3/4 of the way costs 3 * (1/4)^2 + (3/4)^2 = 3/4 per square of the difference, which is 17.
  EXPECT_NEAR(result.final_chi2, 0.75 * 17, 1e-9);
  EXPECT_TRUE(result.switched_off.empty());
}

TEST(Optimize, ALoopsErrorIsSharedByTheEdgesOfASquare) {
  // Four metres round a square, each turn 90 degrees; the last edge is measured 0.4 m too long. All headings
  // are sure, so the four edges share: those along y in their length, those along x sideways.
  PoseGraph graph;
  const core::Pose2 step{1, 0, kPi / 2};
  graph.addNode({0, 0, 0});
  graph.setFixed(0);
  for (int i = 1; i < 4; ++i) {
    graph.addNode(graph.pose(i - 1) * step);
    graph.addEdge(edgeOf(i - 1, i, step));
  }
  graph.addEdge(edgeOf(3, 0, {1.4, 0, kPi / 2}));
  for (int i = 0; i < 4; ++i) {
    Edge sure = edgeOf(kMap, i, {0, 0, i * kPi / 2});
    sure.information.setZero();
    sure.information(2, 2) = 1e12;
    graph.addEdge(sure);
  }
  const auto result = optimize(graph);
  EXPECT_TRUE(result.converged);
  // Edge 3 to 0 runs along -y, as edge 1 to 2 along +y.
  expectPose(graph.pose(1), {1, 0.1, kPi / 2}, 1e-6);
  expectPose(graph.pose(2), {1, 1.2, kPi}, 1e-6);
  expectPose(graph.pose(3), {0, 1.3, -kPi / 2}, 1e-6);
  EXPECT_NEAR(result.final_chi2, 4 * 0.1 * 0.1, 1e-6);
}

TEST(Optimize, APriorHoldsAGraphWithoutAFixedNode) {
  PoseGraph graph;
  graph.addNode({5, 5, 1});
  graph.addNode({0, 0, 0});
  graph.addEdge(edgeOf(kMap, 1, {1, 2, kPi / 2}));
  graph.addEdge(edgeOf(1, 0, {3, 0, 0}));
  EXPECT_TRUE(optimize(graph).converged);
  expectPose(graph.pose(1), {1, 2, kPi / 2}, 1e-9);
  expectPose(graph.pose(0), {1, 5, kPi / 2}, 1e-9);
}

TEST(Optimize, MovesTheWholeResultWithTheStart) {
  PoseGraph here = testing::driveOnGrid(300, 1).graph, there = here;
  const core::Pose2 T_there_here{30, -70, 2.5};
  for (int node = 0; node < here.nodeCount(); ++node) there.setPose(node, T_there_here * here.pose(node));
  const auto a = optimize(here), b = optimize(there);
  EXPECT_GT(a.initial_chi2, 10 * a.final_chi2);
  EXPECT_NEAR(a.initial_chi2, b.initial_chi2, 1e-9 * a.initial_chi2);
  EXPECT_NEAR(a.final_chi2, b.final_chi2, 1e-9 * a.final_chi2);
  for (int node = 0; node < here.nodeCount(); ++node)
    expectPose(there.pose(node), T_there_here * here.pose(node), 1e-8);
}

TEST(Optimize, DoesNotCareForTheOrderOfNodesAndEdges) {
  const PoseGraph graph = testing::driveOnGrid(300, 2).graph;
  core::RandomStream random(1, "shuffle");
  std::vector<int> place(static_cast<size_t>(graph.nodeCount()));  // of a node in the shuffled graph
  std::iota(place.begin(), place.end(), 0);
  for (size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[random.below(i)]);
  std::vector<int> node_at(place.size());
  for (size_t node = 0; node < place.size(); ++node)
    node_at[static_cast<size_t>(place[node])] = static_cast<int>(node);
  PoseGraph shuffled;
  for (const int node : node_at) shuffled.addNode(graph.pose(node));
  shuffled.setFixed(place[0]);
  for (auto edge = graph.edges().rbegin(); edge != graph.edges().rend(); ++edge) {
    Edge moved = *edge;
    moved.from = place[static_cast<size_t>(edge->from)], moved.to = place[static_cast<size_t>(edge->to)];
    shuffled.addEdge(moved);
  }
  PoseGraph plain = graph;
  const auto a = optimize(plain), b = optimize(shuffled);
  EXPECT_NEAR(a.final_chi2, b.final_chi2, 1e-9 * a.final_chi2);
  for (int node = 0; node < graph.nodeCount(); ++node)
    expectPose(shuffled.pose(place[static_cast<size_t>(node)]), plain.pose(node), 1e-8);
}

TEST(Optimize, GivesTheSameBytesEveryTime) {
  for (const char* robust : {"none", "local", "global"}) {
    OptimizeOptions options;
    options.robust = robust;
    PoseGraph graph = testing::driveOnGrid(300, 3).graph;
    core::RandomStream random(3, "false loops");
    testing::addFalseLoops(graph, 0.2, random);
    PoseGraph again = graph;
    optimize(graph, options);
    optimize(again, options);
    for (int node = 0; node < graph.nodeCount(); ++node) {
      EXPECT_EQ(graph.pose(node).x, again.pose(node).x) << robust << " " << node;
      EXPECT_EQ(graph.pose(node).y, again.pose(node).y) << robust << " " << node;
      EXPECT_EQ(graph.pose(node).phi, again.pose(node).phi) << robust << " " << node;
    }
  }
}

TEST(Optimize, FindsTheChi2ThatHonestErrorsHave) {
  double chi2 = 0, freedoms = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    PoseGraph graph = testing::driveOnGrid(200, seed).graph;
    chi2 += optimize(graph).final_chi2;
    freedoms += 3.0 * (static_cast<double>(graph.edges().size()) - (graph.nodeCount() - 1));
  }
  ASSERT_GT(freedoms, 5000);
  // Four standard deviations of chi-square, and 1 % for curvature.
  EXPECT_NEAR(chi2, freedoms, 4 * std::sqrt(2 * freedoms) + 0.01 * freedoms);
}

TEST(Optimize, NeverGoesUpFromAnyStart) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    PoseGraph graph = testing::driveOnGrid(60, seed).graph;
    core::RandomStream random(seed, "start");
    for (int node = 1; node < graph.nodeCount(); ++node) {
      core::Pose2 pose;
      pose.x = random.uniform(-20, 20), pose.y = random.uniform(-20, 20),
      pose.phi = random.uniform(-kPi, kPi);
      graph.setPose(node, pose);
    }
    const auto result = optimize(graph);
    EXPECT_LE(result.final_chi2, result.initial_chi2);
    EXPECT_LE(result.iterations, OptimizeOptions().max_iterations);
    for (const core::Pose2& pose : graph.poses()) EXPECT_TRUE(core::isFinite(pose));
  }
}

TEST(Optimize, ToleranceIsInStandardDeviationsOfThePoses) {
  PoseGraph exact = testing::driveOnGrid(200, 4).graph, coarse = exact;
  OptimizeOptions options;
  options.tolerance = 1e-6;
  EXPECT_TRUE(optimize(exact, options).converged);
  options.tolerance = 0.5;
  const auto result = optimize(coarse, options);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.iterations, 5);
  // 2 cm and half a degree an edge, so poses are sure to a few centimetres.
  EXPECT_LT(largestDistance(exact, coarse), 0.01);
  options.max_iterations = 1;
  options.tolerance = 1e-9;
  PoseGraph hurried = testing::driveOnGrid(200, 4).graph;
  EXPECT_FALSE(optimize(hurried, options).converged);
}

TEST(Optimize, AGraphThatIsDoneStaysWhereItIs) {
  PoseGraph graph = testing::driveOnGrid(200, 5).graph;
  optimize(graph);
  const PoseGraph before = graph;
  const auto result = optimize(graph);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 1);
  EXPECT_LT(largestDistance(before, graph), 1e-6);
}

TEST(Optimize, ExactMeasurementsLeaveNothing) {
  const auto driven = testing::driveOnGrid(100, 6);
  PoseGraph graph;
  for (const core::Pose2& pose : driven.truth) graph.addNode({pose.x + 0.3, pose.y - 0.2, pose.phi});
  graph.setPose(0, driven.truth[0]);
  graph.setFixed(0);
  for (Edge edge : driven.graph.edges()) {
    edge.T_from_to = core::between(driven.truth[static_cast<size_t>(edge.from)],
                                   driven.truth[static_cast<size_t>(edge.to)]);
    graph.addEdge(edge);
  }
  const auto result = optimize(graph);
  EXPECT_TRUE(result.converged);
  EXPECT_LT(result.final_chi2, 1e-12);
  for (int node = 0; node < graph.nodeCount(); ++node)
    expectPose(graph.pose(node), driven.truth[static_cast<size_t>(node)], 1e-9);
}

TEST(Optimize, OneFixedNodeOrNoneAtAllIsNoWork) {
  PoseGraph graph;
  EXPECT_TRUE(optimize(graph).converged);
  graph.addNode({1, 2, 3});
  graph.setFixed(0);
  const auto result = optimize(graph);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.final_chi2, 0);
  EXPECT_EQ(graph.pose(0).phi, 3);
}

TEST(Optimize, RefusesAGraphThatNothingHolds) {
  for (const char* robust : {"none", "local", "global"}) {
    OptimizeOptions options;
    options.robust = robust;
    const auto refused = [&](PoseGraph graph) {
      EXPECT_THROW(optimize(graph, options), core::InputError);
      return testing::errorOf([&] { optimize(graph, options); });
    };
    PoseGraph graph;
    graph.addNode({});
    graph.addNode({});
    graph.addNode({});
    graph.addEdge(edgeOf(0, 1, {1, 0, 0}));
    EXPECT_THAT(refused(graph),
                ::testing::HasSubstr("node 0: found no chain of edges to a fixed node or a prior"));
    graph.setFixed(1);
    EXPECT_THAT(refused(graph), ::testing::HasSubstr("node 2: found no chain"));
    graph.addEdge(edgeOf(2, 1, {1, 0, 0}));
    EXPECT_TRUE(optimize(graph, options).converged);
    graph.setOn(1, false);
    EXPECT_THAT(refused(graph), ::testing::HasSubstr("node 2: found no chain"));
  }
}

TEST(Optimize, ADirectionThatNothingMeasuresIsLeftAsItIs) {
  // Only the distance along x is known.
  PoseGraph graph;
  graph.addNode({});
  graph.setFixed(0);
  graph.addNode({3, 2, 0.5});
  Edge edge = edgeOf(0, 1, {1, 0, 0});
  edge.information.diagonal() << 1, 0, 0;
  graph.addEdge(edge);
  const auto result = optimize(graph);
  EXPECT_FALSE(result.converged) << "and it says so";
  EXPECT_LE(result.final_chi2, result.initial_chi2);
  expectPose(graph.pose(1), {graph.pose(1).x, 2, 0.5}, 1e-9);
}

TEST(Optimize, OptionsAreChecked) {
  PoseGraph graph;
  OptimizeOptions options;
  options.robust = "some";
  EXPECT_THROW(optimize(graph, options), core::ContractError);
  options = OptimizeOptions();
  options.tolerance = 0;
  EXPECT_THROW(optimize(graph, options), core::ContractError);
  options = OptimizeOptions();
  options.switch_off_chi2 = std::nan("");
  EXPECT_THROW(optimize(graph, options), core::ContractError);
}

// The data's README: chi2 at the file's start and at the optimum (SE-Sync's copies of the Intel and Manhattan
// graphs).
TEST(Optimize, ReachesTheKnownOptimumOfIntel) {
  auto graph = realGraph("intel");
  if (!graph) GTEST_SKIP() << "no posegraphs/intel.g2o.xz";
  const auto result = optimize(*graph);
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.initial_chi2, 551.736, 551.736 * 1e-6);
  EXPECT_NEAR(result.final_chi2, 45.0046958, 45.0046958 * 1e-6);
}

TEST(Optimize, ReachesTheKnownOptimumOfManhattanFromOdometry) {
  auto graph = realGraph("manhattan");
  if (!graph) GTEST_SKIP() << "no posegraphs/manhattan.g2o.xz";
  EXPECT_EQ(graph->nodeCount(), 3500);
  const auto result = optimize(*graph);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.initial_chi2, 1e9) << "chained odometry drifts";
  EXPECT_NEAR(result.final_chi2, 3549.0368, 3549.0368 * 1e-6);
}

/// A drive whose poses were thrown about by metres and turns.
PoseGraph thrownAbout(int nodes, std::uint64_t seed) {
  PoseGraph graph = testing::driveOnGrid(nodes, seed).graph;
  core::RandomStream random(seed, "start");
  for (int k = 1; k < nodes; ++k) {
    const core::Pose2 T = graph.pose(k);
    const double x = T.x + 5 * random.normal(), y = T.y + 5 * random.normal();
    graph.setPose(k, {x, y, core::wrapToPi(T.phi + 2 * random.normal())});
  }
  return graph;
}

// Damping rises until steps go down, and falls again: else steps stay short to the end. And a step that was
// rejected is taken anew from where it began.
TEST(Optimize, GoesDownFromAStartThatIsNone) {
  OptimizeOptions options;
  options.robust = "none";
  PoseGraph lucky = thrownAbout(120, 4), unlucky = thrownAbout(120, 1);
  const auto down = optimize(lucky, options);
  EXPECT_TRUE(down.converged);
  EXPECT_LT(down.iterations, 40);
  EXPECT_NEAR(down.final_chi2, 21.793, 0.01) << "the optimum, as from odometry";
  EXPECT_LT(optimize(unlucky, options).final_chi2, 1e5) << "another minimum, at 79 thousand";
}

}  // namespace
}  // namespace slam::posegraph
