// optimize() in pieces: the same bytes, at the same cost.
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/testing/pose_graphs.h"

namespace slam::posegraph {
namespace {

TEST(OptimizeInPieces, GivesTheSameBytesWhateverThePieces) {
  const PoseGraph noisy = testing::driveOnGrid(400, 3).graph;
  PoseGraph whole = noisy;
  OptimizeOptions options;
  options.robust = "none";
  const auto expected = optimize(whole, options);
  double cost = 0;
  for (const double piece : {1.0, 1e5, 1e12}) {
    OptimizeInPieces pieces(noisy, options);
    EXPECT_EQ(pieces.graph().poses().back().x, noisy.poses().back().x);
    int count = 0;
    double spent = 0;
    for (bool is_done = false; !is_done; ++count) {
      double work = piece;
      is_done = pieces.advance(work);
      EXPECT_LE(work, piece);
      spent += piece - work;
    }
    EXPECT_GE(count, piece == 1.0 ? 100 : 1);
    EXPECT_LE(count, piece == 1e12 ? 1 : 1000000);
    EXPECT_EQ(spent, cost == 0 ? spent : cost) << "what it costs depends on the pieces";
    cost = spent;
    const auto result = pieces.finish();
    EXPECT_EQ(result.final_chi2, expected.final_chi2);
    EXPECT_EQ(result.initial_chi2, expected.initial_chi2);
    EXPECT_EQ(result.iterations, expected.iterations);
    EXPECT_TRUE(result.converged);
    ASSERT_EQ(pieces.poses().size(), static_cast<size_t>(whole.nodeCount()));
    for (int node = 0; node < whole.nodeCount(); ++node) {
      const auto& got = pieces.poses()[static_cast<size_t>(node)];
      EXPECT_EQ(got.x, whole.pose(node).x);
      EXPECT_EQ(got.phi, whole.pose(node).phi);
    }
  }
}

// What cannot be divided is paid for before it is done.
TEST(OptimizeInPieces, SolvesOnceThatIsPaidFor) {
  const PoseGraph noisy = testing::driveOnGrid(400, 3).graph;
  OptimizeOptions options;
  options.robust = "none";
  const double cost = GraphSystem(noisy, edgesOn(noisy)).workOfSolving();
  OptimizeInPieces pieces(noisy, options);
  const auto before = pieces.poses();
  double spent = 0;
  int paid = 0;
  for (bool is_done = false; !is_done;) {
    double work = 1;
    is_done = pieces.advance(work);
    spent += 1 - work;
    paid += 1 - work == cost;
    if (paid == 0) {
      EXPECT_EQ(pieces.poses().back().x, before.back().x);
    }
  }
  const int solved = pieces.finish().iterations;
  EXPECT_GT(solved, 1);
  EXPECT_EQ(paid, solved);
  EXPECT_GT(spent, solved * cost);
}

TEST(OptimizeInPieces, RefusesWhatItDoesNotDo) {
  PoseGraph graph;
  graph.addNode({0, 0, 0});
  graph.setFixed(0);
  OptimizeOptions options;
  options.robust = "local";
  EXPECT_THROW(OptimizeInPieces(graph, options), core::ContractError);
  options.robust = "none";
  graph.addNode({1, 0, 0});
  EXPECT_THROW(OptimizeInPieces(graph, options), core::InputError);
}

}  // namespace
}  // namespace slam::posegraph
