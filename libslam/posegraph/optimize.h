#pragma once
#include <vector>

#include "libslam/core/parameters.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Section [posegraph].
struct OptimizeOptions {
  bool robust;              ///< loops may be switched off
  double switch_off_chi2;   ///< a loop whose chi2 stays above this is wrong
  double tolerance;         ///< done when no pose would move by more than so many of its standard deviations
  int max_iterations;       ///< Gauss-Newton steps, in all
  OptimizeOptions();
  static const core::ParameterTable<OptimizeOptions>& table();
};

struct OptimizeResult {
  bool converged = false;  ///< false: max_iterations came first, or the equations are singular
  int iterations = 0;      ///< factorisations
  double initial_chi2 = 0, final_chi2 = 0;  ///< over the edges that were on before, and are on after
  std::vector<int> switched_off;            ///< edges that are off now, ascending
};

OptimizeResult optimize(PoseGraph& graph, const OptimizeOptions& options = {});

}  // namespace slam::posegraph
