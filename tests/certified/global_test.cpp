#include "libslam/certified/global.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libslam/certified/relaxation.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/posegraph/chaining.h"
#include "libslam/posegraph/parts.h"
#include "libslam/testing/pose_graphs.h"
#include "tests/posegraph/real_graphs.h"

namespace slam::certified {
namespace {

using core::kPi;

posegraph::Edge edgeOf(int from, int to, const core::Pose2& T,
                       const Eigen::Vector3d& information = {1, 1, 1}) {
  posegraph::Edge edge;
  edge.from = from, edge.to = to, edge.T_from_to = T;
  edge.information = information.asDiagonal();
  return edge;
}

/// Eight poses at the origin that say of each other that they look the same way, and that are wound up once.
posegraph::PoseGraph woundRing() {
  posegraph::PoseGraph graph;
  for (int i = 0; i < 8; ++i) graph.addNode({0, 0, core::wrapToPi(i * kPi / 4)});
  graph.setFixed(0);
  for (int i = 0; i < 8; ++i) graph.addEdge(edgeOf(i, (i + 1) % 8, {0, 0, 0}));
  return graph;
}

Eigen::Matrix3d someInformation(core::RandomStream& random) {
  Eigen::Matrix3d root;
  for (int i = 0; i < 9; ++i) root(i / 3, i % 3) = random.normal();
  const Eigen::Matrix3d m = 3 * root * root.transpose() + 0.3 * Eigen::Matrix3d::Identity();
  return (m + m.transpose()) / 2;
}

/// Some nodes, each measured from two others or from the map, with errors of a size that makes several
/// minima.
posegraph::PoseGraph smallGraph(core::RandomStream& random, double noise) {
  posegraph::PoseGraph graph;
  const int nodes = 5;
  std::vector<core::Pose2> truth;
  truth.reserve(nodes);
  for (int i = 0; i < nodes; ++i)
    truth.push_back({random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-kPi, kPi)});
  for (const auto& pose : truth) graph.addNode(pose);
  graph.setFixed(0);
  const auto measure = [&](int from, int to) {
    const core::Pose2 a = from == posegraph::kMap ? core::Pose2() : truth[static_cast<size_t>(from)];
    core::Pose2 z = core::between(a, truth[static_cast<size_t>(to)]);
    z = z * core::Pose2{random.normal(noise), random.normal(noise), random.normal(noise)};
    posegraph::Edge edge;
    edge.from = from, edge.to = to, edge.T_from_to = z;
    edge.information = someInformation(random);
    graph.addEdge(edge);
  };
  for (int i = 1; i < nodes; ++i) measure(i - 1, i);
  for (int i = 2; i < nodes; ++i) measure(i, i - 2);
  measure(posegraph::kMap, 3);
  return graph;
}

posegraph::PoseGraph moved(posegraph::PoseGraph graph, const std::vector<core::Pose2>& poses) {
  posegraph::startAt(graph, poses);
  return graph;
}

TEST(Certificate, AMinimumThatIsNotTheLeastIsNotCertified) {
  posegraph::PoseGraph graph = woundRing();
  const auto local = posegraph::optimize(graph);
  EXPECT_TRUE(local.converged) << "each edge is an eighth of a turn off, and none can do better alone";
  EXPECT_NEAR(local.final_chi2, 8 * kPi * kPi / 16, 1e-6);
  const Certificate certificate = certify(graph);
  EXPECT_FALSE(certificate.is_optimal);
  EXPECT_LE(certificate.lower_bound, 1e-9) << "unwound it would be 0";

  const auto global = optimizeGlobally(graph);
  EXPECT_TRUE(global.from_relaxation);
  EXPECT_TRUE(global.certificate.is_optimal);
  EXPECT_NEAR(global.optimum.final_chi2, 0, 1e-9);
}

TEST(Certificate, PosesThatAreNoMinimumAreNotCertified) {
  auto graph = testing::driveOnGrid(100, 5).graph;
  EXPECT_FALSE(certify(graph).is_optimal);
  EXPECT_TRUE(optimizeGlobally(graph).certificate.is_optimal);
}

TEST(Certificate, NoPosesAreBelowTheBound) {
  // Brute force: descents from many starts. Information of any shape, errors up to where there are several
  // minima.
  core::RandomStream random(3, "bound");
  int certified = 0, several = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double noise = 0.05 * (1 + trial % 12);
    posegraph::PoseGraph graph = smallGraph(random, noise);
    const auto found = optimizeGlobally(graph);
    const double slack = kCertified * (1 + found.optimum.final_chi2);
    EXPECT_LE(found.certificate.lower_bound, found.optimum.final_chi2 + slack);
    certified += found.certificate.is_optimal;
    bool has_other = false;
    for (int start = 0; start < 20; ++start) {
      posegraph::PoseGraph other = moved(graph, posegraph::scattered(graph, {random.bits(), "start"}));
      const double chi2 = posegraph::optimize(other).final_chi2;
      EXPECT_GE(chi2, found.certificate.lower_bound - slack) << "trial " << trial;
      EXPECT_EQ(chi2 < found.optimum.final_chi2 - slack && found.certificate.is_optimal, false);
      EXPECT_LE(certify(other).lower_bound, found.optimum.final_chi2 + slack)
          << "of a minimum that is not the least";
      has_other = has_other || chi2 > found.optimum.final_chi2 + 10 * slack;
    }
    several += has_other;
  }
  EXPECT_GT(certified, 20) << "of 60";
  EXPECT_GT(several, 20) << "or the test is too easy";
}

TEST(Certificate, AWholeDriveIsCertifiedFromAnyStart) {
  // Errors of 0.2 m and 5 degrees a metre: chained odometry knows nothing any more.
  auto graph = testing::driveOnGrid(300, 2, 10).graph;
  posegraph::PoseGraph start = moved(graph, posegraph::scattered(graph, {1, "start"}));
  const auto from_odometry = optimizeGlobally(graph), from_anywhere = optimizeGlobally(start);
  EXPECT_TRUE(from_odometry.certificate.is_optimal);
  EXPECT_TRUE(from_anywhere.certificate.is_optimal);
  EXPECT_NEAR(from_anywhere.optimum.final_chi2, from_odometry.optimum.final_chi2,
              kCertified * from_odometry.optimum.final_chi2);
}

TEST(Certificate, FixedNodesAndPriorsHoldTheMap) {
  // A pose between two fixed ones that disagree by 0.2 m, and a prior that agrees with the first.
  posegraph::PoseGraph graph;
  graph.addNode({1, 2, 0.3});
  graph.addNode({0, 0, 0});
  graph.addNode({3, 2, 0.3});
  graph.setFixed(0);
  graph.setFixed(2);
  graph.addEdge(edgeOf(0, 1, {1, 0, 0}));
  graph.addEdge(edgeOf(2, 1, {-0.8, 0, 0}));
  graph.addEdge(edgeOf(posegraph::kMap, 1, core::Pose2{1, 2, 0.3} * core::Pose2{1, 0, 0}));
  const auto result = optimizeGlobally(graph);
  EXPECT_TRUE(result.certificate.is_optimal);
  EXPECT_GT(result.optimum.final_chi2, 0.01);
  EXPECT_NEAR(result.certificate.lower_bound, result.optimum.final_chi2, 2e-6);
}

TEST(Certificate, NothingIsBelowZeroEvenWhereADirectionIsNotMeasured) {
  posegraph::PoseGraph graph;
  graph.addNode({0, 0, 0});
  graph.addNode({1, 4, 1});
  graph.setFixed(0);
  graph.addEdge(edgeOf(0, 1, {1, 0, 0}, {1, 0, 0}));
  const Certificate certificate = certify(graph);
  EXPECT_TRUE(certificate.is_optimal);
  EXPECT_EQ(certificate.lower_bound, 0);
}

TEST(Certificate, FalseLoopsAreSwitchedOffBeforeItIsAsked) {
  auto driven = testing::driveOnGrid(300, 4);
  core::RandomStream random(9, "false");
  const int wrong = testing::addFalseLoops(driven.graph, 0.1, random);
  posegraph::OptimizeOptions options;
  options.robust = "global";
  const auto result = optimizeGlobally(driven.graph, options);
  EXPECT_EQ(static_cast<int>(result.optimum.switched_off.size()), wrong);
  EXPECT_TRUE(result.certificate.is_optimal);
}

TEST(Certificate, TheRealGraphsAreCertified) {
  for (const auto& [name, optimum] :
       std::vector<std::pair<std::string, double>>{{"intel", 45.0046958}, {"manhattan", 3549.0368}}) {
    auto graph = posegraph::realGraph(name);
    if (!graph) GTEST_SKIP() << "no posegraphs";
    const auto result = optimizeGlobally(*graph);
    EXPECT_TRUE(result.certificate.is_optimal) << name;
    EXPECT_NEAR(result.certificate.lower_bound, optimum, 2 * kCertified * (1 + optimum)) << name;
  }
}

TEST(RelaxedPoses, AreRightWhereHardlyAnythingErrsAndOweNothingToTheStart) {
  auto driven = testing::driveOnGrid(200, 3, 1e-6);
  const posegraph::PoseGraph graph = moved(driven.graph, posegraph::scattered(driven.graph, {2, "start"}));
  const auto poses = relaxedPoses(graph);
  const auto same = relaxedPoses(driven.graph);
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(core::distance(poses[i], same[i]), 0) << "the same bytes from any start";
    EXPECT_EQ(poses[i].phi, same[i].phi);
    EXPECT_LT(core::distance(poses[i], driven.truth[i]), 1e-3);
    EXPECT_NEAR(std::remainder(poses[i].phi - driven.truth[i].phi, 2 * kPi), 0, 1e-5);
  }
}

TEST(RelaxedPoses, ANodeWithoutHeadingGetsTheMaps) {
  posegraph::PoseGraph graph;
  graph.addNode({1, 1, 0});
  graph.addNode({5, 5, 2});
  graph.setFixed(0);
  graph.addEdge(edgeOf(0, 1, {2, 0, 1}, {1, 1, 0}));
  const auto poses = relaxedPoses(graph);
  EXPECT_NEAR(poses[1].x, 3, 1e-6);
  EXPECT_NEAR(poses[1].y, 1, 1e-6);
  EXPECT_EQ(poses[1].phi, 0);
}

TEST(RelaxedPoses, AnEdgeCountsTheSameFromEitherEnd) {
  posegraph::PoseGraph graph, turned;
  for (int i = 0; i < 3; ++i) graph.addNode({}), turned.addNode({});
  graph.setFixed(0), turned.setFixed(0);
  const core::Pose2 first{1, 0, 0.7}, second{2, 1, -1.1}, third{3, 0, 0.2};
  for (const auto& edge : {edgeOf(0, 1, first), edgeOf(1, 2, second), edgeOf(0, 2, third)}) {
    graph.addEdge(edge);
    turned.addEdge(edgeOf(edge.to, edge.from, core::inverse(edge.T_from_to)));
  }
  const auto poses = relaxedPoses(graph), same = relaxedPoses(turned);
  for (size_t i = 0; i < 3; ++i) EXPECT_NEAR(poses[i].phi, same[i].phi, 1e-9);
}

TEST(Chained, GoesAlongOdometryBeforeLoopsAndNotAlongEdgesThatAreOff) {
  posegraph::PoseGraph graph;
  for (int i = 0; i < 4; ++i) graph.addNode({9, 9, 9});
  graph.setFixed(0);
  graph.setPose(0, {1, 0, 0});
  posegraph::Edge loop = edgeOf(0, 2, {7, 7, 0});
  loop.kind = posegraph::EdgeKind::kLoop;
  graph.addEdge(loop);
  graph.addEdge(edgeOf(0, 1, {1, 0, kPi / 2}));
  graph.addEdge(edgeOf(1, 2, {1, 0, 0}));
  const int off = graph.addEdge(edgeOf(2, 3, {5, 0, 0}));
  graph.setOn(off, false);
  graph.addEdge(edgeOf(3, 0, {-1, 0, 0}));
  const auto poses = posegraph::chained(graph);
  EXPECT_NEAR(core::distance(poses[2], {2, 1, kPi / 2}), 0, 1e-12);
  EXPECT_NEAR(core::distance(poses[3], {2, 0, 0}), 0, 1e-12);
}

TEST(PartsOf, NamesWhatNothingTiesTogether) {
  posegraph::PoseGraph graph;
  for (int i = 0; i < 6; ++i) graph.addNode({});
  graph.addEdge(edgeOf(0, 2, {}));
  graph.addEdge(edgeOf(1, 4, {}));
  EXPECT_EQ(posegraph::partsOf(graph), (std::vector<std::vector<int>>{{0, 2}, {1, 4}, {3}, {5}}));
  graph.setFixed(2);
  graph.addEdge(edgeOf(posegraph::kMap, 5, {}));
  EXPECT_EQ(posegraph::partsOf(graph), (std::vector<std::vector<int>>{{0, 2, 5}, {1, 4}, {3}}))
      << "held is held";
  EXPECT_THROW(optimizeGlobally(graph), core::InputError);
}

}  // namespace
}  // namespace slam::certified
