#pragma once
#include "libslam/report/table.h"
#include "libslam/study/sweep_tables.h"

namespace slam::study {

/// Whether the covariances that methods state are true: one row per method that states any, for every setting and, where
/// there are several, for all together. ANEES (evaluate.h), the shares of poses within the ellipsoids that should hold 50
/// and 95 % of them, of the online and of the final poses: means over the runs, since a median would not show that a
/// method is sometimes far overconfident, with bootstrap intervals over the runs (BCa; all together: within each setting). Poses
/// of one run hang together, so runs are what is drawn. A verdict where the whole interval of ANEES lies on one side of 1.
/// Runs that went astray count: a method that does not know it is overconfident. No rows: no method states covariances.
/// The same bytes for the same results.
struct SweepConsistency {
  report::Table main;  ///< without the axes that do not vary; an interval and its figure in one cell
  report::Table all;   ///< every figure in a column of its own
};
SweepConsistency sweepConsistency(const sweep::SweepPlan& plan, const SweepResults& results);

}  // namespace slam::study
