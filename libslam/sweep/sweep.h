#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/resources/manifest.h"
#include "libslam/sweep/sweep_plan.h"

namespace slam::sweep {

/// How to carry out a sweep, or a part of it.
struct SweepRequest {
  std::string output;   ///< folder
  std::string program;  ///< rasterslam, see sweep()
  core::Progress* cell_progress =
      &core::silentProgress();  ///< of each cell; may throw Interrupted, must not print
  int jobs = 1;                 ///< cells side by side
  bool resume = false;          ///< go on in a folder that is there; what is complete is kept
  bool overwrite = false;
  bool retry = false;             ///< do cells again that ended otherwise than ok
  std::size_t shard = 1, of = 1;  ///< part `shard` of `of`: all runs of a log are in one part
  std::string only_cell;          ///< id: that cell alone, and the log that it needs; "" = all
};

/// What was done. A cell counts as failed when its status is not ok.
struct SweepOutcome {
  std::size_t done = 0, reused = 0, failed = 0;
  std::vector<std::string>
      lost;  ///< cells that could not be finished, one line each: --resume tries them again
  std::vector<std::string> repaired;  ///< what was found damaged and done again, one line each
};

/// Does the cells of a sweep that are not complete yet. In `output`:
///   suite.ini       the suite as it was given; of one in YAML the same as .ini
///   plan.json       the cells (SweepPlan)
///   manifest.json   command line
///   cells/ID/       one folder per cell, see cell.h; it appears whole or not at all
///   partial/        cells in flight, one folder per process that runs them, locked while that process lives
/// Any number of processes may work in one folder, on one machine or several with a common disk (flock(2)
/// must work there), on different shards or on the same.
///
/// Each cell is a process of its own: a copy of this one where that is sound (hasOneThread()), else
/// `PROGRAM bench cell FOLDER ...`; both give the same bytes.
///
/// Limits ([limits] of the suite) end a cell as a result: "timeout", "out of memory"; so does a signal that
/// its own doing raised: "crashed". A cell that was killed from outside is tried three times and then left
/// for --resume. A log that cannot be made fails its runs. Whatever stops the sweep (an error, an interrupt,
/// kill -9) loses the cells in flight at most; their folders are removed at once or by the next sweep in this
/// folder.
///
/// The cells' results do not depend on jobs, shards or the order of work. Errors: InputError (an output that
/// is not ours, or holds another sweep), IoError (the disk is full), core::Interrupted.
SweepOutcome sweep(const Sweep& sweep, const SweepRequest& request, const resources::Manifest& manifest,
                   core::Progress& progress);

/// Makes the folder and its suite.ini, plan.json and manifest.json, as sweep() does first.
void prepareSweepFolder(const Sweep& sweep, const SweepRequest& request, const resources::Manifest& manifest);

/// How to do one cell again, as a shell line to be given in the sweep's folder.
std::string reproduceLine(const std::string& id);

}  // namespace slam::sweep
