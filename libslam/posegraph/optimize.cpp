#include "libslam/posegraph/optimize.h"

#include <cmath>
#include <cstdlib>
#include <string>

#include "libslam/core/error.h"
#include "libslam/posegraph/edge_error.h"
#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/parts.h"

namespace slam::posegraph {
namespace {

// Levenberg's damping, relative to the diagonal: none while steps go down.
constexpr double kFirstDamping = 1e-4, kDampingUp = 10, kDampingDown = 0.1, kLeastDamping = 1e-7, kMostDamping = 1e8;
/// chi2 may rise by so much of itself through rounding.
constexpr double kRounding = 1e-12;

std::vector<core::Pose2> moved(const PoseGraph& graph, const GraphSystem& system, const std::vector<core::Pose2>& poses,
                               const std::vector<Eigen::Vector3d>& step) {
  std::vector<core::Pose2> out = poses;
  for (int node = 0; node < graph.nodeCount(); ++node) {
    const int variable = system.variableOf(node);
    if (variable < 0) continue;
    const Eigen::Vector3d& d = step[static_cast<size_t>(variable)];
    core::Pose2& pose = out[static_cast<size_t>(node)];
    pose = {pose.x + d[0], pose.y + d[1], core::wrapToPi(pose.phi + d[2])};
  }
  return out;
}

/// Least squares with the weights as they are.
struct Descent {
  const PoseGraph& graph;
  GraphSystem& system;
  std::vector<core::Pose2> poses;
  double chi2 = 0;
  int iterations = 0;
  bool converged = false;

  void run(const std::vector<double>& weights, double tolerance, int most_iterations) {
    chi2 = system.linearise(graph, poses, weights);
    converged = false;
    double damping = 0;
    std::vector<Eigen::Vector3d> step;
    for (int i = 0; i < most_iterations && !converged && damping < kMostDamping; ++i) {
      double predicted = 0;
      ++iterations;
      if (!system.step(damping, step, predicted)) {
        damping = std::max(kFirstDamping, kDampingUp * damping);
        continue;
      }
      const bool is_small = damping == 0 && predicted <= tolerance * tolerance;
      auto next = moved(graph, system, poses, step);
      const double next_chi2 = system.linearise(graph, next, weights);
      if (getenv("PG_TRACE")) printf("   it %d chi2 %.9f -> %.9f predicted %g damping %g\n", i, chi2, next_chi2, predicted, damping);
      if (next_chi2 <= chi2 * (1 + kRounding)) {
        poses = std::move(next);
        chi2 = next_chi2;
        converged = is_small;
        damping = damping <= kLeastDamping ? 0 : kDampingDown * damping;
      } else if (is_small) {
        converged = true;  // what is left is rounding
      } else {
        damping = std::max(kFirstDamping, kDampingUp * damping);
        system.linearise(graph, poses, weights);
      }
    }
  }
};

}  // namespace

OptimizeOptions::OptimizeOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<OptimizeOptions>& OptimizeOptions::table() {
  static const core::ParameterTable<OptimizeOptions> rows(
      "posegraph",
      {{"robust", &OptimizeOptions::robust, false, "loops may be switched off where they contradict the rest"},
       {"switch_off_chi2", &OptimizeOptions::switch_off_chi2, 16.27, 1e-3, 1e9,
        "a loop whose chi2 stays above this is switched off (16.27: one true loop in a thousand)"},
       {"tolerance", &OptimizeOptions::tolerance, 1e-3, 1e-9, 1.0,
        "done when no pose would move by more than so many of its standard deviations"},
       {"max_iterations", &OptimizeOptions::max_iterations, 200, 1, 1000000, "Gauss-Newton steps at most"}});
  return rows;
}

OptimizeResult optimize(PoseGraph& graph, const OptimizeOptions& options) {
  OptimizeResult result;
  const size_t edges = graph.edges().size();
  std::vector<char> used(edges);
  std::vector<double> weights(edges, 1.0);
  for (size_t i = 0; i < edges; ++i) used[i] = graph.edges()[i].on;
  GraphSystem system(graph, used);
  Descent descent{graph, system, graph.poses()};
  result.initial_chi2 = graph.chi2();
  descent.run(weights, options.tolerance, options.max_iterations);
  result.converged = descent.converged;
  result.iterations = descent.iterations;
  for (int node = 0; node < graph.nodeCount(); ++node) graph.setPose(node, descent.poses[static_cast<size_t>(node)]);
  result.final_chi2 = graph.chi2();
  return result;
}

}  // namespace slam::posegraph
