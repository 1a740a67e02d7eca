#pragma once
#include "libslam/posegraph/certificate.h"
#include "libslam/posegraph/optimize.h"

namespace slam::posegraph {

struct GlobalResult {
  OptimizeResult optimum;  ///< initial_chi2 is that of the graph's own poses; iterations over all descents
  bool from_relaxation = false;  ///< the relaxation led lower than the graph's own poses
  Certificate certificate;       ///< for the loops that are on
};

/// As optimize(), and then not at the mercy of the start: a second descent begins at relaxedPoses(), the lower end is
/// kept, brought to a millionth of a standard deviation, and certify() asked about it. With a robust choice of loops
/// the graph's own poses decide first which loops are on; where the relaxation of these leads lower, the loops are
/// judged once more from there.
///
/// Deterministic. Cost: two to three times that of optimize(), or more where this needs many steps.
/// Errors: as optimize().
GlobalResult optimizeGlobally(PoseGraph& graph, const OptimizeOptions& options = {});

}  // namespace slam::posegraph
