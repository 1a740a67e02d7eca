#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libslam/files/parameters.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Section [posegraph].
struct OptimizeOptions {
  std::string robust;         ///< none | local | global: see optimize()
  double switch_off_chi2;     ///< a loop is wrong when without it the graph's chi2 is lower by more than this
  double switch_off_medians;  ///< ... or by more than so many times the median loop; 0: this rule is off
  double tolerance;    ///< done when no pose would move by more than so many of its standard deviations
  int max_iterations;  ///< steps of one descent
  OptimizeOptions();
  static const files::ParameterTable<OptimizeOptions>& table();
};

struct OptimizeResult {
  bool converged = false;  ///< false: max_iterations came first, or nothing but damped steps goes down
  int iterations = 0;      ///< factorisations, in all
  double initial_chi2 = 0,
         final_chi2 = 0;          ///< over the edges that were on before, and over those that are on after
  std::vector<int> switched_off;  ///< loops that are off now, ascending
};

/// Moves the nodes that are not fixed to where the graph's chi2 is least, starting from where they are:
/// Gauss-Newton, with steps shortened and then damped (Levenberg) where they would go up. It finds the
/// minimum that the start leads to: poses chained along the odometry will do unless the heading drifts by a
/// radian or so between loops; optimizeGlobally() needs no such luck.
///
/// `robust` says which loops count; edges of kind kOdometry are never switched by it:
///   none    every edge that is on.
///   local   on and off as they are to begin with (a new loop should be on); then loops are switched, either
///           way, until none costs more than switch_off_chi2 that is on, and none less that is off. For a
///           graph that grows: when nothing is wrong it costs up to twice as much as `none`.
///   global  from no loop at all, taking in those that the graph is surest of first; then as `local`; and
///           where that leaves out more than one in ten, also from all of them, keeping what is better: the
///           least sum of chi2 and switch_off_chi2 for every loop that is off. The poses are needed as a
///           start all the same. For a whole graph of which nothing is known: it finds its way when every
///           second loop is wrong, and takes some dozens of `none`.
/// The graph keeps the switches. What a loop costs is what the whole graph's chi2 would fall by without it:
/// its own chi2 is less, as odometry gives way to a false loop closure. So odometry that claims to be better
/// than it is makes right loops look wrong; and switch_off_chi2 is not exceeded by one right loop in a
/// million when all information is honest (three degrees of freedom). Where it is conservative, false loops
/// hide in its slack: switch_off_medians finds the scale from the loops themselves. A loop that alone ties a
/// part of the graph to the rest is never off.
///
/// A graph that grows: from its old poses it takes two or three steps, and new edges may wait. At the minimum
/// the edges that are added since move no pose by more than the root of the sum of their own chi2() in its
/// standard deviations, so there is nothing to do until that sum is worth it.
///
/// Deterministic: the same graph gives the same bytes. Cost: each step is linear in the edges plus the
/// factorisation; benchmarks/results/posegraph.txt has figures (1700 nodes with 2500 edges in 3 ms, 3500 with
/// 5500 in 13 ms). Errors: InputError for a node that no chain of edges that are on ties to a fixed node or
/// to a prior; ContractError for an unknown `robust` or a number out of its row's bounds.
OptimizeResult optimize(PoseGraph& graph, const OptimizeOptions& options = {});

/// optimize() with `robust` none, in pieces and on a graph of its own: for who cannot wait for all of it. The
/// result's bytes are those of optimize(), whatever the pieces.
class OptimizeInPieces {
 public:
  /// Errors: as optimize(). REQUIRES robust none (ContractError).
  OptimizeInPieces(PoseGraph graph, const OptimizeOptions& options);
  ~OptimizeInPieces();
  /// One piece; true when all is done. `work`: how much, in multiplications, about (5e6 take a millisecond or
  /// so); what was done is taken off: see threads::PacedWork. Two pieces cannot be divided, and are paid for
  /// before they are done: the analysis of the graph's structure, and to give its edges their places in the
  /// equations, together about what a factorisation costs.
  bool advance(double& work);
  /// All that is left.
  OptimizeResult finish();
  const PoseGraph& graph() const;
  /// As far as it has come; of graph()'s nodes.
  const std::vector<core::Pose2>& poses() const;

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace slam::posegraph
