#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/sweep/suite.h"

namespace slam::sweep {

/// Folder of one cell of a sweep, named by its id:
///   cell.json     the spec that the id is the hash of
///   result.json   how it ended: the same bytes for the same id, whenever and wherever it is made
///   cost.json     time and memory: differ from run to run
///   failure.json  of a run that left the truth (firstDivergence()): where and why, see readFailure()
///   stderr.txt    what a crashed one said last, if anything
/// and of a log what record() writes (with plan.yaml where the building was generated), of a run a folder
/// `run` of what buildMap() writes (Suite keep = paths: without the forms for MRPT's viewers), of a method
/// that failed on the way likewise.

/// result.json.
struct CellResult {
  std::string id;
  std::string status = "ok";  ///< ok | failed | timeout | out of memory | crashed
  std::string message;        ///< why, unless ok
  double limit = 0;           ///< the limit that a timeout or out of memory came from, else 0
  std::vector<std::pair<std::string, double>> figures;  ///< key -> value, NaN where there is none
  struct File {
    std::uint64_t bytes = 0;
    std::string sha256;
  };
  std::map<std::string, File> files;  ///< path in the folder -> what it holds, for those that never differ
};

/// cost.json; NaN where it is not known.
struct CellCost {
  double cpu_s, wall_s;  ///< of the whole process
  double mean_ms_per_scan, p99_ms_per_scan, peak_memory_mb;
  CellCost();
};

/// What a cell reads besides its spec: paths, "" where there is none.
struct CellInputs {
  std::string plan;                               ///< of a log
  std::string log, truth, truth_plan, relations;  ///< of a run
  std::string keep = "paths", reproduce;          ///< reproduce: a shell line for the manifests
  CellLimits limits;
};

/// Does the cell whose cell.json lies in `folder`, and writes everything else beside it, result.json last. A
/// method that fails or takes more memory than it may is a result; only what has nothing to do with the cell
/// is an error: IoError, Interrupted, InputError for a broken cell.json or a plan that is no longer the
/// planned one. The limits of time (SIGXCPU) and memory are the process's own from then on, so this is for a
/// process that does nothing else.
void workOnCell(const std::string& folder, const CellInputs& inputs, core::Progress& progress);

/// Writes cost.json and, last, result.json: what has a result is complete.
void writeCellResult(const std::string& folder, const CellResult& result, const CellCost& cost);
/// The same for a cell that could not say itself how it ended: whatever it left is removed first, but for
/// cell.json and stderr.txt.
void writeLostCell(const std::string& folder, const CellResult& result, const CellCost& cost);

/// What there is of a cell.
struct CellState {
  enum Kind { kMissing, kDamaged, kComplete } kind = kMissing;
  std::string reason;  ///< of kDamaged: one line with the path
  CellResult result;
};
/// Complete: cell.json hashes to `id`, result.json belongs to it, its files are there in their size; with
/// `check_bytes` in their bytes too.
CellState readCell(const std::string& folder, const std::string& id, bool check_bytes = false);
CellCost readCellCost(const std::string& folder);

}  // namespace slam::sweep
