#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/resources/manifest.h"
#include "libslam/summary/run_figures.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/table/table.h"

namespace slam::summary {

struct MergeRequest {
  std::vector<std::string> folders;  ///< of one sweep: parts that were done apart, or a single one
  std::string output;                ///< folder of the whole; may be one of them
  bool check_bytes = false;          ///< read every file of every cell again
};

struct MergedSweep {
  sweep::SweepPlan plan;
  std::size_t complete = 0, failed = 0;  ///< runs
  std::vector<std::string> missing;      ///< one line per cell that is not there, or damaged
  SweepResults results;
  table::Table summary, full_summary, consistency, costs;
};

/// Brings the cells of a sweep together and writes into `output`:
///   results.csv .json             one row per run
///   summary.txt .md .tex .csv .json   statistics over the seeds
///   consistency.txt .md .tex .csv .json   whether the covariances are consistent: sweepConsistency()
///   failures.csv .json .txt       where and why runs failed: sweepFailures()
///   cost.csv .json, cost_summary.txt .csv   time and memory: differ from run to run, as nothing else here
///                                           does
///   index.sqlite                  writeSweepIndex()
///   manifest.json                 command line, how many are missing
/// Cells of other folders are linked (or copied) into output/cells. A missing or damaged cell is a row that
/// says "missing". Errors: folders of different sweeps, one cell with two different results, naming both
/// (InputError).
MergedSweep mergeSweep(const MergeRequest& request, resources::Manifest manifest, core::Progress& progress);

}  // namespace slam::summary
