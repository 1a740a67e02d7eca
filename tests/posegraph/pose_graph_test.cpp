#include "libslam/posegraph/pose_graph.h"
#include "libslam/core/numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/testing/error_of.h"

namespace slam::posegraph {
namespace {

using core::kInfinity;
using core::kNaN;

PoseGraph twoNodes() {
  PoseGraph graph;
  graph.addNode({0, 0, 0});
  graph.addNode({1, 0, 0});
  return graph;
}

Edge edgeBetween(int from, int to) {
  Edge edge;
  edge.from = from, edge.to = to;
  return edge;
}

TEST(PoseGraph, CountsChi2OverTheEdgesThatAreOn) {
  PoseGraph graph = twoNodes();
  Edge edge = edgeBetween(0, 1);
  edge.T_from_to = {0.5, 0, 0};
  edge.information.diagonal() << 4, 1, 1;
  EXPECT_EQ(graph.addEdge(edge), 0);
  EXPECT_EQ(graph.addEdge(edgeBetween(kMap, 1)), 1);
  EXPECT_EQ(graph.chi2(0), 1);
  EXPECT_EQ(graph.chi2(1), 1);
  EXPECT_EQ(graph.chi2(), 2);
  const core::Pose2 before = graph.edges()[0].T_from_to;
  graph.setOn(0, false);
  EXPECT_EQ(graph.chi2(), 1);
  EXPECT_EQ(graph.chi2(0), 1) << "of one edge: on or off";
  graph.setMeasurement(0, {3, 0, 0});
  EXPECT_EQ(graph.edges()[0].T_from_to.x, 3);
  EXPECT_THROW(graph.setMeasurement(0, {kNaN, 0, 0}), core::ContractError);
  graph.setMeasurement(0, before);
  graph.setPose(1, {0, 0, 0});
  EXPECT_EQ(graph.chi2(), 0);
}

TEST(PoseGraph, RefusesWhatIsNoGraph) {
  PoseGraph graph = twoNodes();
  const auto refused = [&](const Edge& edge) {
    EXPECT_THROW(graph.addEdge(edge), core::ContractError);
    return testing::errorOf([&] { graph.addEdge(edge); });
  };
  EXPECT_THAT(refused(edgeBetween(0, 2)), ::testing::HasSubstr("node 2 of 2"));
  EXPECT_THAT(refused(edgeBetween(-2, 1)), ::testing::HasSubstr("node -2"));
  EXPECT_THAT(refused(edgeBetween(0, kMap)), ::testing::HasSubstr("node -1"));
  EXPECT_THAT(refused(edgeBetween(1, 1)), ::testing::HasSubstr("to itself"));
  Edge edge = edgeBetween(0, 1);
  edge.T_from_to.phi = kNaN;
  EXPECT_THAT(refused(edge), ::testing::HasSubstr("measurement that is not finite"));
  EXPECT_THROW(graph.addNode({0, kInfinity, 0}), core::ContractError);
  EXPECT_THROW(graph.setPose(1, {0, kNaN, 0}), core::ContractError);
  EXPECT_THROW(graph.setPose(2, {}), core::ContractError);
  EXPECT_THROW(graph.setFixed(-1), core::ContractError);
  EXPECT_THROW(graph.setOn(0, true), core::ContractError);
  EXPECT_THROW(graph.setMeasurement(0, {}), core::ContractError);
  EXPECT_THROW(graph.chi2(0), core::ContractError);
  EXPECT_THROW(graph.pose(2), core::ContractError);
  EXPECT_THROW(graph.isFixed(2), core::ContractError);
  EXPECT_TRUE(graph.edges().empty());
}

TEST(PoseGraph, InformationMayBeSingularButNotIndefinite) {
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
  EXPECT_STREQ(informationProblem(information), "");
  information.diagonal() << 1, 0, 0;
  EXPECT_STREQ(informationProblem(information), "");
  information.diagonal() << 1, 1, -0.001;
  EXPECT_STREQ(informationProblem(information), "indefinite");
  information = Eigen::Matrix3d::Identity();
  information(0, 2) = information(2, 0) = 1.5;
  EXPECT_STREQ(informationProblem(information), "indefinite");
  information = Eigen::Matrix3d::Identity();
  information(0, 1) = 0.1;
  EXPECT_STREQ(informationProblem(information), "not symmetric");
  EXPECT_STREQ(informationProblem(Eigen::Matrix3d::Zero()), "zero");
  EXPECT_STREQ(informationProblem(Eigen::Matrix3d::Constant(kNaN)), "an entry that is not finite");
  PoseGraph graph = twoNodes();
  Edge edge = edgeBetween(0, 1);
  edge.information.setZero();
  EXPECT_THAT(testing::errorOf([&] { graph.addEdge(edge); }),
              ::testing::HasSubstr("information matrix: zero"));
}

}  // namespace
}  // namespace slam::posegraph
