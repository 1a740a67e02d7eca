#include "libslam/posegraph/marginals.h"

#include <string>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::posegraph {

Marginals::Marginals(const PoseGraph& graph) : poses_(graph.poses()), system_(graph, edgesOn(graph)) {
  system_.linearise(graph, poses_, std::vector<double>(graph.edges().size(), 1.0));
  if (!system_.factorize())
    throw core::MethodError("pose graph: the edges do not determine every pose; there is no covariance");
}

/// Empty for a fixed node.
sparse::BlockCholesky::HalfColumn Marginals::halfColumn(int node) const {
  if (node < 0 || static_cast<size_t>(node) >= poses_.size())
    throw core::ContractError("Marginals: node " + std::to_string(node) + " of " +
                              std::to_string(poses_.size()));
  const int variable = system_.variableOf(node);
  return variable < 0 ? sparse::BlockCholesky::HalfColumn() : system_.factor().halfColumn(variable);
}

Eigen::Matrix3d Marginals::covariance(int node) const {
  const auto half = halfColumn(node);
  return sparse::BlockCholesky::inverseBlock(half, half);
}

std::vector<Eigen::Matrix3d> Marginals::all() const {
  const auto by_variable = system_.factor().sparseInverse().diagonal;
  std::vector<Eigen::Matrix3d> out(poses_.size(), Eigen::Matrix3d::Zero());
  for (size_t node = 0; node < out.size(); ++node) {
    const int variable = system_.variableOf(static_cast<int>(node));
    if (variable >= 0) out[node] = by_variable[static_cast<size_t>(variable)];
  }
  return out;
}

Eigen::Matrix<double, 6, 6> Marginals::joint(int a, int b) const {
  const auto half_a = halfColumn(a), half_b = halfColumn(b);
  const Eigen::Matrix3d ab = sparse::BlockCholesky::inverseBlock(half_a, half_b);
  Eigen::Matrix<double, 6, 6> out;
  out << sparse::BlockCholesky::inverseBlock(half_a, half_a), ab, ab.transpose(),
      sparse::BlockCholesky::inverseBlock(half_b, half_b);
  return out;
}

Eigen::Matrix3d Marginals::relative(int a, int b) const {
  const Eigen::Matrix<double, 6, 6> both = joint(a, b);
  return relativeCovariance(both, poses_[static_cast<size_t>(a)], poses_[static_cast<size_t>(b)]);
}

Eigen::Matrix3d relativeCovariance(const Eigen::Matrix<double, 6, 6>& joint, const core::Pose2& T_map_a,
                                   const core::Pose2& T_map_b) {
  const auto [s, c] = core::sinCos(T_map_a.phi);
  const double dx = T_map_b.x - T_map_a.x, dy = T_map_b.y - T_map_a.y;
  Eigen::Matrix<double, 3, 6> J;
  J << -c, -s, c * dy - s * dx, c, s, 0, s, -c, -c * dx - s * dy, -s, c, 0, 0, 0, -1, 0, 0, 1;
  return J * joint * J.transpose();
}

}  // namespace slam::posegraph
