#pragma once
#include <Eigen/Core>
#include <vector>

#include "libslam/posegraph/pose_graph.h"
#include "libslam/sparse/block_cholesky.h"

namespace slam::posegraph {

/// Which edges count: those that are on.
std::vector<char> edgesOn(const PoseGraph& graph);

/// The normal equations of a graph: one block row per node that is not fixed. What optimize() and Marginals
/// share.
class GraphSystem {
 public:
  /// Takes the graph's structure; edges between fixed nodes and edges given as unused are left out. Errors:
  /// InputError for a node that no chain of used edges ties to a fixed node or to a prior.
  GraphSystem(const PoseGraph& graph, const std::vector<char>& is_used);

  /// Fills the equations at these poses, edge i counting `weights[i]` times; returns the weighted chi2.
  double linearise(const PoseGraph& graph, const std::vector<core::Pose2>& poses,
                   const std::vector<double>& weights);
  /// The same in pieces: begin, then lineariseMore() until it is true, with the same arguments;
  /// weightedChi2(). `work` as in sparse::BlockCholesky::advance().
  void beginLinearise();
  bool lineariseMore(const PoseGraph& graph, const std::vector<core::Pose2>& poses,
                     const std::vector<double>& weights, double& work);
  double weightedChi2() const { return chi2_; }
  /// The Gauss-Newton step of linearise()'s equations, one per variable, and what chi2 should fall by. False
  /// when the equations are singular. `damping` as in sparse::BlockCholesky::factorize().
  bool step(double damping, std::vector<Eigen::Vector3d>& step, double& predicted);
  /// The same in pieces: of the factorisation; then solve(), with the factor.
  void beginFactorization(double damping) { cholesky_.beginFactorization(damping); }
  sparse::BlockCholesky::Progress advanceFactorization(double& work) { return cholesky_.advance(work); }
  void solve(std::vector<Eigen::Vector3d>& step, double& predicted) const;
  double workOfSolving() const { return cholesky_.workOfSolving(); }

  /// Covariance of each used edge's error as the equations have it, by edge; zero for the others. REQUIRES a
  /// factor.
  std::vector<Eigen::Matrix3d> errorCovariances(const PoseGraph& graph,
                                                const std::vector<core::Pose2>& poses) const;
  /// The same of one edge, used or not.
  Eigen::Matrix3d errorCovariance(const Edge& edge, const std::vector<core::Pose2>& poses) const;

  /// Which block row a node has; -1 when it is fixed.
  int variableOf(int node) const { return variable_[static_cast<size_t>(node)]; }
  const sparse::BlockCholesky& factor() const { return cholesky_; }
  /// As step() without the step. REQUIRES linearise() before.
  bool factorize() { return cholesky_.factorize(); }

 private:
  struct Term {
    int edge, a, b;  ///< block rows of the edge's ends, -1: fixed or the map
    int block;       ///< of the pair (a, b) in cholesky_, -1 when one end is fixed
  };
  std::vector<int> variable_;
  std::vector<Term> terms_;
  sparse::BlockCholesky cholesky_;
  std::vector<Eigen::Vector3d> gradient_;
  double chi2_ = 0;
  size_t next_term_ = 0;  ///< of the linearisation that goes on
};

}  // namespace slam::posegraph
