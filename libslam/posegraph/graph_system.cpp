#include "libslam/posegraph/graph_system.h"

#include <limits>

#include "libslam/posegraph/edge_error.h"
#include "libslam/posegraph/parts.h"

namespace slam::posegraph {
namespace {

/// An edge takes as long to linearise as so many of a factorisation's multiplications.
constexpr double kWorkPerEdge = 600;

/// Covariance of an edge's error from those of its ends.
Eigen::Matrix3d propagated(const Edge& edge, const std::vector<core::Pose2>& poses, const Eigen::Matrix3d& aa,
                           const Eigen::Matrix3d& ab, const Eigen::Matrix3d& bb) {
  const core::Pose2 a = edge.from == kMap ? core::Pose2() : poses[static_cast<size_t>(edge.from)];
  const auto J = edgeJacobian(a, poses[static_cast<size_t>(edge.to)], edge.T_from_to);
  Eigen::Matrix<double, 6, 6> joint;
  joint << aa, ab, ab.transpose(), bb;
  return J * joint * J.transpose();
}

}  // namespace

std::vector<char> edgesOn(const PoseGraph& graph) {
  std::vector<char> on;
  on.reserve(graph.edges().size());
  for (const Edge& edge : graph.edges()) on.push_back(edge.on);
  return on;
}

GraphSystem::GraphSystem(const PoseGraph& graph, const std::vector<char>& is_used) {
  requireHeld(graph, is_used);
  int variables = 0;
  for (int node = 0; node < graph.nodeCount(); ++node)
    variable_.push_back(graph.isFixed(node) ? -1 : variables++);
  std::vector<std::pair<int, int>> blocks;
  blocks.reserve(graph.edges().size());
  terms_.reserve(graph.edges().size());
  for (size_t i = 0; i < graph.edges().size(); ++i) {
    if (!is_used[i]) continue;
    const Edge& edge = graph.edges()[i];
    Term term{static_cast<int>(i), edge.from == kMap ? -1 : variableOf(edge.from), variableOf(edge.to), -1};
    if (term.a >= 0 && term.b >= 0) {
      term.block = static_cast<int>(blocks.size());
      blocks.emplace_back(term.a, term.b);
    }
    terms_.push_back(term);
  }
  cholesky_.analyse(variables, blocks);
  gradient_.resize(static_cast<size_t>(variables));
}

void GraphSystem::beginLinearise() {
  cholesky_.setZero();
  std::fill(gradient_.begin(), gradient_.end(), Eigen::Vector3d::Zero());
  chi2_ = 0;
  next_term_ = 0;
}

bool GraphSystem::lineariseMore(const PoseGraph& graph, const std::vector<core::Pose2>& poses,
                                const std::vector<double>& weights, double& work) {
  for (; next_term_ < terms_.size() && work > 0; ++next_term_, work -= kWorkPerEdge) {
    const Term& term = terms_[next_term_];
    const double w = weights[static_cast<size_t>(term.edge)];
    const Edge& edge = graph.edges()[static_cast<size_t>(term.edge)];
    const core::Pose2 a = edge.from == kMap ? core::Pose2() : poses[static_cast<size_t>(edge.from)];
    const EdgeQuadratic q = edgeQuadratic(a, poses[static_cast<size_t>(edge.to)], edge);
    chi2_ += w * q.chi2;
    if (term.a >= 0) {
      cholesky_.addDiagonal(term.a, w * q.aa);
      gradient_[static_cast<size_t>(term.a)] += w * q.g_a;
    }
    if (term.b >= 0) {
      cholesky_.addDiagonal(term.b, w * q.bb);
      gradient_[static_cast<size_t>(term.b)] += w * q.g_b;
    }
    if (term.block >= 0) cholesky_.addBlock(term.block, w * q.ab);
  }
  return next_term_ == terms_.size();
}

double GraphSystem::linearise(const PoseGraph& graph, const std::vector<core::Pose2>& poses,
                              const std::vector<double>& weights) {
  beginLinearise();
  double unlimited = std::numeric_limits<double>::infinity();
  lineariseMore(graph, poses, weights, unlimited);
  return chi2_;
}

void GraphSystem::solve(std::vector<Eigen::Vector3d>& step, double& predicted) const {
  step = gradient_;
  cholesky_.solve(step);
  predicted = 0;
  for (size_t i = 0; i < step.size(); ++i) {
    step[i] = -step[i];
    predicted -= gradient_[i].dot(step[i]);
  }
}

bool GraphSystem::step(double damping, std::vector<Eigen::Vector3d>& step, double& predicted) {
  if (!cholesky_.factorize(damping)) return false;
  solve(step, predicted);
  return true;
}

std::vector<Eigen::Matrix3d> GraphSystem::errorCovariances(const PoseGraph& graph,
                                                           const std::vector<core::Pose2>& poses) const {
  const sparse::BlockCholesky::SparseInverse inverse = cholesky_.sparseInverse();
  std::vector<Eigen::Matrix3d> out(graph.edges().size(), Eigen::Matrix3d::Zero());
  for (const Term& term : terms_) {
    const Edge& edge = graph.edges()[static_cast<size_t>(term.edge)];
    const Eigen::Matrix3d none = Eigen::Matrix3d::Zero();
    out[static_cast<size_t>(term.edge)] =
        propagated(edge, poses, term.a < 0 ? none : inverse.diagonal[static_cast<size_t>(term.a)],
                   term.block < 0 ? none : inverse.blocks[static_cast<size_t>(term.block)],
                   term.b < 0 ? none : inverse.diagonal[static_cast<size_t>(term.b)]);
  }
  return out;
}

Eigen::Matrix3d GraphSystem::errorCovariance(const Edge& edge, const std::vector<core::Pose2>& poses) const {
  const auto halfColumn = [this](int node) {
    const int variable = node == kMap ? -1 : variableOf(node);
    return variable < 0 ? sparse::BlockCholesky::HalfColumn() : cholesky_.halfColumn(variable);
  };
  const auto a = halfColumn(edge.from), b = halfColumn(edge.to);
  return propagated(edge, poses, sparse::BlockCholesky::inverseBlock(a, a),
                    sparse::BlockCholesky::inverseBlock(a, b), sparse::BlockCholesky::inverseBlock(b, b));
}

}  // namespace slam::posegraph
