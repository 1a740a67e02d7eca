#pragma once
#include "libslam/certified/certificate.h"
#include "libslam/posegraph/optimize.h"

namespace slam::certified {

struct GlobalResult {
  posegraph::OptimizeResult
      optimum;  ///< initial_chi2 is that of the graph's own poses; iterations over all descents
  bool from_relaxation = false;  ///< the relaxation led lower than the graph's own poses
  Certificate certificate;       ///< for the loops that are on
};

/// As optimize(), and then not at the mercy of the start: the end is brought to a millionth of a standard
/// deviation and certify() asked about it. Where it is not certified a second descent begins at
/// relaxedPoses(), and what is lower is kept and asked about. With a robust choice of loops the graph's own
/// poses decide first which loops are on; where the relaxation of these leads lower, the loops are judged
/// once more from there.
///
/// Deterministic. Cost: twice that of optimize() where its end is certified, else four times or more.
/// Errors: as optimize().
GlobalResult optimizeGlobally(posegraph::PoseGraph& graph, const posegraph::OptimizeOptions& options = {});

}  // namespace slam::certified
