#pragma once
#include "libslam/summary/run_figures.h"
#include "libslam/table/table.h"

namespace slam::summary {

/// Whether the covariances that methods state are true: one row per method that states any, for every setting
/// and, where there are several, for all together. ANEES (evaluate.h), the shares of poses within the
/// ellipsoids that should hold 50 and 95 % of them, of the online and of the final poses: means over the
/// runs, since a median would not show that a method is sometimes far overconfident, with intervals over the
/// runs (meanInterval(); all together: within each setting). Poses of one run hang together, so a run is one
/// value. A verdict where the whole interval of ANEES lies on one side of 1; overconfident whatever ANEES
/// says where more than 5 % of the covariances are singular and exclude where the robot was. Runs that went
/// astray count: a method that does not know it is overconfident. No rows: no method states covariances. The
/// same bytes for the same results.
struct SweepConsistency {
  table::Table main;  ///< without the axes that do not vary; an interval and its figure in one cell
  table::Table all;   ///< every figure in a column of its own
};
SweepConsistency sweepConsistency(const sweep::SweepPlan& plan, const SweepResults& results);

}  // namespace slam::summary
