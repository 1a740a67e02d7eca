#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/files/parameters.h"
#include "libslam/resources/manifest.h"
#include "libslam/study/tune_statistics.h"
#include "libslam/table/table.h"

namespace slam::study {

/// Section [tune] of a suite.
struct TuneOptions {
  std::string train, hold_out;
  int hold_out_seeds, reduction;
  TuneOptions();
  static const files::ParameterTable<TuneOptions>& table();
};

struct TuneRequest {
  std::string method;           ///< by name or .ini, as in a suite's list
  std::string suite_path;       ///< with a section [tune], and maybe [tune.parameters]
  std::size_t budget = 0;       ///< training runs at most
  std::uint64_t seed = 1;       ///< of the draws
  std::string output, program;  ///< as in SweepRequest, so are the next
  int jobs = 1;
  bool resume = false, overwrite = false;
  core::Progress* cell_progress = &core::silentProgress();
};

struct TuneResult {
  table::Table candidates, sensitivity, held_out;
  std::string verdict;  ///< one line
  std::string tuned_path;
  bool is_better = false;         ///< than the default on the held-out worlds, significantly
  std::vector<std::string> lost;  ///< cells that could not be finished: --resume tries them again
};

/// Tunes a method by successive halving (Jamieson and Talwalkar, AISTATS 2016; seeds are the resource) and
/// judges the result where it was not tuned. Candidates are the method as it is ("default") and draws of all
/// parameters of [tune.parameters] (of the suite, else of configs/tune/METHOD.ini:
/// `section.key = LOW..HIGH[:log]` or a list), by the stream "tune". On each rung they are ranked by the
/// suite's metric on every log of the training worlds with seeds 1, 2, ...; a failed run is worse than any
/// other, and the mean rank over the logs counts, so that no world outweighs the others. Those on the last
/// rung (three at most) then meet the default on the held-out worlds, with seeds from 1001 on:
/// heldOutVerdict(), once. Where the default itself was first in training nothing is judged.
/// Worlds, lidars, odometry, strategies, faults, limits and failure_ate_m are the suite's; its methods, logs
/// and seeds are not used. Writes into `output`:
///   METHOD_tuned.ini          the chosen candidate's configuration, whatever the verdict; its head says how
///                             sure it is
///   candidates.txt .csv .json      every candidate: its parameters, how far it came, its mean rank on each
///                                  rung
///   sensitivity.txt .csv .json     on the first rung, that all candidates share
///   verdict.txt
///   training/, held_out/      sweeps (sweep()), the latter with mergeSweep()'s tables
/// Same suite, budget, seed and code: the same bytes (but for cost and manifests); --resume goes on. Errors:
/// InputError (no or unknown worlds in [tune], a world on both sides, no parameters, a budget that is too
/// small), IoError, Interrupted.
TuneResult tune(const TuneRequest& request, const resources::Manifest& manifest, core::Progress& progress);

}  // namespace slam::study
