#pragma once
#include <vector>

#include "libslam/posegraph/graph_system.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Where a descent ended.
struct Descent {
  std::vector<core::Pose2> poses;
  double chi2 = 0;
  int iterations = 0;  ///< factorisations
  bool converged = false;
};

/// Weighted least squares from `poses`: Gauss-Newton, with steps shortened and then damped (Levenberg) while
/// they would go up. A step adds to x, y
/// and phi in the map's frame. `tolerance` as in OptimizeOptions.
Descent descend(const PoseGraph& graph, GraphSystem& system, std::vector<core::Pose2> poses,
                const std::vector<double>& weights, double tolerance, int max_iterations);

}  // namespace slam::posegraph
