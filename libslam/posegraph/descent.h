#pragma once
#include <vector>

#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/pose_graph.h"
#include "libslam/threads/paced_work.h"

namespace slam::posegraph {

/// Weighted least squares: Gauss-Newton, with steps shortened and then damped (Levenberg) while they would go
/// up. A step adds to x, y and phi in the map's frame. In pieces, so that nobody has to wait for all of it.
///
/// REQUIRES that the graph and the system live as long, and that the graph does not change meanwhile.
/// Deterministic: the same bytes, whatever the pieces.
class Descent {
 public:
  /// From `poses`; edge i counts `weights[i]` times. `tolerance` as in OptimizeOptions.
  Descent(const PoseGraph& graph, GraphSystem& system, std::vector<core::Pose2> poses,
          std::vector<double> weights, double tolerance, int max_iterations);
  /// One piece; true when all is done: see threads::PacedWork::Step. `work` as in
  /// sparse::BlockCholesky::advance().
  bool advance(double& work);
  /// All that is left.
  void finish();

  const std::vector<core::Pose2>& poses() const { return poses_; }
  double chi2() const { return chi2_; }
  double firstChi2() const { return first_chi2_; }  ///< where it began
  int iterations() const { return iterations_; }    ///< factorisations
  bool converged() const { return converged_; }

 private:
  /// What the piece to come goes on with: kStart, kBack linearise at poses_, kTry at next_.
  enum class Doing { kStart, kFactorise, kSolve, kTry, kBack, kNothing };
  void linearise(Doing doing);
  void iterate();
  void raiseDamping();
  void takeStep();
  void judgeStep();
  std::vector<core::Pose2> moved(double share) const;

  const PoseGraph& graph_;
  GraphSystem& system_;
  std::vector<core::Pose2> poses_, next_;
  std::vector<double> weights_;
  double tolerance_;
  int max_iterations_, iterations_ = 0;
  bool converged_ = false, is_last_ = false;
  double chi2_ = 0, first_chi2_ = 0, damping_ = 0, share_ = 1;
  std::vector<Eigen::Vector3d> step_;
  Doing doing_ = Doing::kStart;
  threads::PaidFirst solving_;
};

}  // namespace slam::posegraph
