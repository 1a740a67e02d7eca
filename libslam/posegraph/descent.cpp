#include "libslam/posegraph/descent.h"

#include <algorithm>
#include <utility>

namespace slam::posegraph {
namespace {

// Damping, relative to the diagonal: none while steps go down.
constexpr double kFirstDamping = 1e-4, kDampingUp = 10, kDampingDown = 0.1, kLeastDamping = 1e-7,
                 kMostDamping = 1e8;
/// Of a step that would go up, the least share that is tried before it is damped. Damping holds the long
/// waves of a graph back more than its short ones, and steps go up along the short ones.
constexpr double kLeastShare = 0.1;
/// chi2 may rise by so much of itself through rounding.
constexpr double kRounding = 1e-12;

std::vector<core::Pose2> moved(const PoseGraph& graph, const GraphSystem& system,
                               const std::vector<core::Pose2>& poses,
                               const std::vector<Eigen::Vector3d>& step, double share) {
  std::vector<core::Pose2> out = poses;
  for (int node = 0; node < graph.nodeCount(); ++node) {
    const int variable = system.variableOf(node);
    if (variable < 0) continue;
    const Eigen::Vector3d d = share * step[static_cast<size_t>(variable)];
    core::Pose2& pose = out[static_cast<size_t>(node)];
    pose = {pose.x + d[0], pose.y + d[1], core::wrapToPi(pose.phi + d[2])};
  }
  return out;
}

}  // namespace

Descent descend(const PoseGraph& graph, GraphSystem& system, std::vector<core::Pose2> poses,
                const std::vector<double>& weights, double tolerance, int max_iterations) {
  Descent out;
  out.poses = std::move(poses);
  out.chi2 = system.linearise(graph, out.poses, weights);
  double damping = 0;
  std::vector<Eigen::Vector3d> step;
  while (out.iterations < max_iterations && !out.converged && damping < kMostDamping) {
    double predicted = 0;
    ++out.iterations;
    if (!system.step(damping, step, predicted)) {
      damping = std::max(kFirstDamping, kDampingUp * damping);
      continue;
    }
    // The undamped step's fall of chi2 is its length in standard deviations, squared, and bounds that of
    // every pose.
    const bool is_last = damping == 0 && predicted <= tolerance * tolerance;
    auto next = moved(graph, system, out.poses, step, 1);
    double next_chi2 = system.linearise(graph, next, weights);
    for (double share = 0.5; !is_last && next_chi2 > out.chi2 && share >= kLeastShare; share /= 2) {
      next = moved(graph, system, out.poses, step, share);
      next_chi2 = system.linearise(graph, next, weights);
    }
    if (next_chi2 <= out.chi2 * (1 + kRounding)) {
      out.poses = std::move(next);
      out.chi2 = next_chi2;
      out.converged = is_last;
      damping = damping <= kLeastDamping ? 0 : kDampingDown * damping;
    } else if (is_last) {
      out.converged = true;  // what is left to gain is below rounding
    } else {
      damping = std::max(kFirstDamping, kDampingUp * damping);
      system.linearise(graph, out.poses, weights);
    }
  }
  return out;
}

}  // namespace slam::posegraph
