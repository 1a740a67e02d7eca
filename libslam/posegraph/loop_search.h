#pragma once
#include <optional>
#include <vector>

#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Poses, and which edges are on.
struct LoopChoice {
  std::vector<core::Pose2> poses;
  std::vector<char> on;  ///< by edge
  double chi2 = 0;       ///< of the edges that are on
  bool converged = false;
};

/// Looks for the loops to switch off, as optimize() describes.
///
/// What a loop costs is judged without removing it: with S the covariance of its error as the graph has it, e
/// its error and W its information, the graph's chi2 falls by e' (W^-1 - S)^-1 e when a loop that is on is
/// left out, and rises by e' (W^-1 + S)^-1 e when one that is off is taken in (both to first order; the one
/// is the deletion residual of regression diagnostics, the other the innovation of a Kalman filter). S of all
/// loops costs three factorisations.
class LoopSearch {
 public:
  LoopSearch(const PoseGraph& graph, const OptimizeOptions& options);
  /// From the graph's poses and switches.
  LoopChoice improve();
  /// From its poses and no loop: those that the graph is surest of come first, so that the graph gets surer
  /// and the next are judged harder (in the spirit of the forward search of Atkinson and Riani, 2000). Where
  /// that leaves out many, improve() from all loops is tried as well, and what costs less is taken.
  LoopChoice build();
  int iterations() const { return iterations_; }

 private:
  struct Verdict {
    double chi2;       ///< what the loop costs the graph's chi2, or would cost
    double looseness;  ///< how much less sure the graph is of the loop than the loop itself; 0 when on
  };
  void improve(LoopChoice& choice);
  void build(LoopChoice& choice);
  void settleFinely(LoopChoice& choice);
  void settleCoarsely(LoopChoice& choice);
  void settle(LoopChoice& choice, double tolerance, int max_iterations);
  std::vector<Verdict> judge(const LoopChoice& choice, bool with_parked);
  double limit(const LoopChoice& choice, const std::vector<Verdict>& verdicts) const;
  double worstThatIsOn(const LoopChoice& choice, const std::vector<Verdict>& verdicts) const;
  double loosestToTake(const LoopChoice& choice, const std::vector<Verdict>& verdicts, double most) const;
  void keepTogether(LoopChoice& choice, const std::vector<Verdict>& verdicts) const;
  double cost(const LoopChoice& choice) const;

  const PoseGraph& graph_;
  OptimizeOptions options_;
  std::vector<size_t> loops_;    // edges
  std::vector<char> is_bridge_;  // by loop: it ties parts that no odometry ties
  std::vector<char> is_parked_;  // by loop: off, and out of the equations' pattern, which it would fill
  std::vector<double> weights_;  // by edge, as settled last
  std::optional<GraphSystem> system_;
  int iterations_ = 0;
};

}  // namespace slam::posegraph
