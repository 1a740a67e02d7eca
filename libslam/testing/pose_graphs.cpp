#include "libslam/testing/pose_graphs.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace slam::testing {
namespace {

constexpr int kBlock_m = 5, kLeastAge = 20;
constexpr double kNear_m = 2;
const double kSigma_m = 0.02, kSigma_rad = core::degToRad(0.5);

posegraph::Edge measure(const DrivenGraph& driven, int from, int to, posegraph::EdgeKind kind, double noise,
                        core::RandomStream& random) {
  const core::Pose2 T =
      core::between(driven.truth[static_cast<size_t>(from)], driven.truth[static_cast<size_t>(to)]);
  posegraph::Edge edge;
  edge.from = from, edge.to = to, edge.kind = kind;
  // The error is that of the estimate seen from the measurement, so the measurement is truth times its
  // inverse.
  const double sigma_m = noise * kSigma_m, sigma_rad = noise * kSigma_rad;
  core::Pose2 error;
  error.x = random.normal(sigma_m), error.y = random.normal(sigma_m), error.phi = random.normal(sigma_rad);
  edge.T_from_to = T * core::inverse(error);
  edge.information =
      Eigen::Vector3d(1 / (sigma_m * sigma_m), 1 / (sigma_m * sigma_m), 1 / (sigma_rad * sigma_rad))
          .asDiagonal();
  return edge;
}

}  // namespace

DrivenGraph driveOnGrid(int nodes, std::uint64_t seed, double noise) {
  core::RandomStream turns(seed, "turns"), errors(seed, "errors");
  DrivenGraph out;
  core::Pose2 truth;
  for (int node = 0; node < nodes; ++node) {
    if (node > 0) {
      truth = truth * core::Pose2{1, 0, 0};
      if (node % kBlock_m == 0)
        truth.phi = core::wrapToPi(truth.phi + (double(turns.below(3)) - 1) * core::kPi / 2);
    }
    out.truth.push_back(truth);
    if (node == 0) {
      out.graph.addNode(truth);
      out.graph.setFixed(0);
      continue;
    }
    const auto odometry = measure(out, node - 1, node, posegraph::EdgeKind::kOdometry, noise, errors);
    out.graph.addNode(out.graph.pose(node - 1) * odometry.T_from_to);
    out.graph.addEdge(odometry);
    for (int old = 0; old + kLeastAge <= node; ++old)
      if (core::distance(out.truth[static_cast<size_t>(old)], truth) < kNear_m)
        out.graph.addEdge(measure(out, old, node, posegraph::EdgeKind::kLoop, noise, errors));
  }
  return out;
}

int addFalseLoops(posegraph::PoseGraph& graph, double share, core::RandomStream& random) {
  std::vector<Eigen::Matrix3d> information;
  for (const posegraph::Edge& edge : graph.edges())
    if (edge.kind == posegraph::EdgeKind::kLoop) information.push_back(edge.information);
  const int count = static_cast<int>(std::lround(share * static_cast<double>(information.size())));
  const auto anyNode = [&] {
    return static_cast<int>(random.below(static_cast<std::uint64_t>(graph.nodeCount())));
  };
  for (int i = 0; i < count;) {
    const int a = anyNode(), b = anyNode();
    if (std::abs(a - b) < kLeastAge) continue;
    posegraph::Edge edge;
    edge.from = std::min(a, b), edge.to = std::max(a, b), edge.kind = posegraph::EdgeKind::kLoop;
    edge.T_from_to.x = random.uniform(-5, 5);
    edge.T_from_to.y = random.uniform(-5, 5);
    edge.T_from_to.phi = random.uniform(-core::kPi, core::kPi);
    edge.information = information[random.below(information.size())];
    graph.addEdge(edge);
    ++i;
  }
  return count;
}

}  // namespace slam::testing
