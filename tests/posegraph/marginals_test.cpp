#include "libslam/posegraph/marginals.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/posegraph/edge_error.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/testing/pose_graphs.h"

namespace slam::posegraph {
namespace {

/// Inverse of the whole information matrix; a huge weight on node 0, which is fixed.
Eigen::MatrixXd denseCovariance(const PoseGraph& graph) {
  const long size = 3L * graph.nodeCount();
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(size, size);
  for (const Edge& edge : graph.edges()) {
    if (!edge.on) continue;
    const core::Pose2 a = edge.from == kMap ? core::Pose2() : graph.pose(edge.from);
    const auto J = edgeJacobian(a, graph.pose(edge.to), edge.T_from_to);
    const Eigen::Matrix<double, 6, 6> H = J.transpose() * edge.information * J;
    if (edge.from != kMap) {
      information.block<3, 3>(3L * edge.from, 3L * edge.from) += H.topLeftCorner<3, 3>();
      information.block<3, 3>(3L * edge.from, 3L * edge.to) += H.topRightCorner<3, 3>();
      information.block<3, 3>(3L * edge.to, 3L * edge.from) += H.bottomLeftCorner<3, 3>();
    }
    information.block<3, 3>(3L * edge.to, 3L * edge.to) += H.bottomRightCorner<3, 3>();
  }
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(size, size);
  out.bottomRightCorner(size - 3, size - 3) = information.bottomRightCorner(size - 3, size - 3).inverse();
  return out;
}

TEST(Marginals, EqualTheDenseInverse) {
  PoseGraph graph = testing::driveOnGrid(120, 1).graph;
  optimize(graph);
  int loop = 0;
  while (graph.edges()[static_cast<size_t>(loop)].kind != EdgeKind::kLoop) ++loop;
  graph.setOn(loop, false);
  const Eigen::MatrixXd dense = denseCovariance(graph);
  const double tolerance = 1e-9 * dense.cwiseAbs().maxCoeff();
  const Marginals marginals(graph);
  const auto all = marginals.all();
  for (int a = 0; a < graph.nodeCount(); a += 7) {
    EXPECT_LT((marginals.covariance(a) - dense.block<3, 3>(3L * a, 3L * a)).cwiseAbs().maxCoeff(), tolerance);
    EXPECT_LT((all[static_cast<size_t>(a)] - dense.block<3, 3>(3L * a, 3L * a)).cwiseAbs().maxCoeff(),
              tolerance);
    for (int b = 0; b < graph.nodeCount(); b += 11) {
      const auto joint = marginals.joint(a, b);
      const Eigen::Matrix3d ab = joint.topRightCorner<3, 3>();
      EXPECT_LT((ab - dense.block<3, 3>(3L * a, 3L * b)).cwiseAbs().maxCoeff(), tolerance) << a << ", " << b;
      EXPECT_TRUE(joint.isApprox(joint.transpose(), 1e-9));
    }
  }
}

TEST(Marginals, AlongACorridorVariancesAddUpAndHeadingsLever) {
  // Ten edges of 1 m; 1 cm along, 2 cm across, 0.01 rad each.
  PoseGraph graph;
  graph.addNode({});
  graph.setFixed(0);
  Edge edge;
  edge.T_from_to = {1, 0, 0};
  edge.information.diagonal() << 1e4, 2500, 1e4;
  for (int node = 1; node <= 10; ++node) {
    edge.from = node - 1, edge.to = node;
    graph.addNode({double(node), 0, 0});
    graph.addEdge(edge);
  }
  const Marginals marginals(graph);
  const Eigen::Matrix3d end = marginals.covariance(10);
  EXPECT_NEAR(end(0, 0), 10e-4, 1e-12);
  EXPECT_NEAR(end(2, 2), 10e-4, 1e-12);
  double across = 10 * 4e-4;
  for (int lever = 1; lever < 10; ++lever) across += 1e-4 * lever * lever;
  EXPECT_NEAR(end(1, 1), across, 1e-12);
  EXPECT_EQ(marginals.covariance(0), Eigen::Matrix3d::Zero()) << "fixed";

  // Between neighbours it is the edge's own, wherever they are; and the same seen from behind a moved map.
  EXPECT_LT((marginals.relative(6, 7) - edge.information.inverse()).norm(), 1e-10);
  for (int node = 0; node <= 10; ++node) graph.setPose(node, core::Pose2{3, 4, 2} * graph.pose(node));
  const Marginals turned(graph);
  EXPECT_LT((turned.relative(2, 8) - marginals.relative(2, 8)).norm(), 1e-10);
  const Eigen::Matrix3d turned_end = turned.covariance(10);
  EXPECT_NEAR(turned_end(0, 0) + turned_end(1, 1), end(0, 0) + end(1, 1), 1e-12);
}

TEST(Marginals, RelativeIsToFirstOrderTheCovarianceOfWhatBetweenGives) {
  PoseGraph graph = testing::driveOnGrid(80, 2).graph;
  optimize(graph);
  const Marginals marginals(graph);
  for (const auto& [a, b] : {std::pair{0, 40}, {40, 0}, {13, 77}, {77, 13}, {5, 5}}) {
    const core::Pose2 p = graph.pose(a), q = graph.pose(b);
    Eigen::Matrix<double, 3, 6> J;
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 6; ++k) {
      const auto shifted = [&](double by) {
        core::Pose2 u = p, v = q;
        double* const numbers[] = {&u.x, &u.y, &u.phi, &v.x, &v.y, &v.phi};
        *numbers[k] += by;
        const core::Pose2 T = core::between(u, v);
        return Eigen::Vector3d(T.x, T.y, T.phi);
      };
      J.col(k) = (shifted(kStep) - shifted(-kStep)) / (2 * kStep);
    }
    const Eigen::Matrix3d expected = J * marginals.joint(a, b) * J.transpose();
    EXPECT_LT((marginals.relative(a, b) - expected).norm(), 1e-7 * (expected.norm() + 1e-6))
        << a << ", " << b;
  }
}

TEST(Marginals, CoverTheErrorsThatAreMade) {
  double nees = 0;
  int count = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    auto [graph, truth] = testing::driveOnGrid(100, seed);
    optimize(graph);
    const Marginals marginals(graph);
    const int node = 99;  // one a run, for independence
    const core::Pose2 &p = graph.pose(node), &t = truth[node];
    const Eigen::Vector3d error(p.x - t.x, p.y - t.y, core::angleDifference(p.phi, t.phi));
    nees += error.dot(marginals.covariance(node).ldlt().solve(error));
    ++count;
  }
  // Mean of chi-square with three degrees of freedom, within three standard deviations.
  EXPECT_NEAR(nees / count, 3, 3 * std::sqrt(6.0 / count));
}

TEST(Marginals, AreASnapshot) {
  PoseGraph graph = testing::driveOnGrid(60, 3).graph;
  optimize(graph);
  const Marginals marginals(graph);
  const Eigen::Matrix3d before = marginals.covariance(59);
  graph.setPose(59, {100, 100, 1});
  EXPECT_EQ(marginals.covariance(59), before);
}

TEST(Marginals, RefuseWhereRankIsLost) {
  PoseGraph graph;
  graph.addNode({});
  graph.addNode({});
  graph.setFixed(0);
  Edge edge;
  edge.from = 0, edge.to = 1;
  // y and heading against each other stay open.
  edge.information << 1, 0, 0, 0, 1, 1, 0, 1, 1;
  graph.addEdge(edge);
  EXPECT_THROW(Marginals{graph}, core::MethodError);
}

TEST(Marginals, RefuseWhatIsNotDetermined) {
  PoseGraph graph;
  graph.addNode({});
  graph.addNode({});
  graph.setFixed(0);
  EXPECT_THROW(Marginals{graph}, core::InputError) << "node 1 hangs on nothing";
  Edge edge;
  edge.from = 0, edge.to = 1;
  edge.information.diagonal() << 1, 1, 0;
  graph.addEdge(edge);
  EXPECT_THROW(Marginals{graph}, core::MethodError) << "its heading is open";
  edge.information.diagonal() << 0, 0, 1;
  graph.addEdge(edge);
  const Marginals marginals(graph);
  EXPECT_TRUE(marginals.covariance(1).isIdentity(1e-12));
  EXPECT_THROW(marginals.covariance(2), core::ContractError);
  EXPECT_THROW(marginals.covariance(-1), core::ContractError);
  EXPECT_THROW(marginals.relative(0, 2), core::ContractError);
}

}  // namespace
}  // namespace slam::posegraph
