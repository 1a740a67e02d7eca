#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/manifest.h"
#include "libslam/core/parameters.h"
#include "libslam/core/progress.h"
#include "libslam/report/table.h"
#include "libslam/stats/paired.h"
#include "libslam/study/value_range.h"

namespace slam::study {

/// Section [tune] of a suite.
struct TuneOptions {
  std::string train, hold_out;
  int hold_out_seeds, reduction;
  TuneOptions();
  static const core::ParameterTable<TuneOptions>& table();
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

/// One rung of successive halving.
struct TuneRung {
  std::size_t candidates, seeds;
};
/// The largest schedule within a budget of runs: on every rung `reduction` times the seeds of the one before, and of the
/// candidates the best 1 / reduction (rounded up), until three or fewer are left. Runs of a rung that the one before has made
/// are not made again. Errors: InputError with the least budget (three candidates, one seed).
std::vector<TuneRung> tuneSchedule(std::size_t budget, std::size_t logs_per_seed, std::size_t reduction);

/// How much a parameter matters.
struct Sensitivity {
  std::string key;
  double share =
      0;  ///< of the variance of the mean rank that it explains, less chance (stats::explainedVariance())
  double p = 1;      ///< by Holm's method over the parameters
  std::string best;  ///< the third of the drawn values (or the value of a list) with the best mean rank
};
/// settings[c] of candidate c: one text per key, in the order of keys; scores[c]: small is good. Numbers are put into thirds
/// of equal size. With fewer than 6 candidates nothing is known: share 0, p 1.
std::vector<Sensitivity> sensitivities(const std::vector<std::string>& keys,
                                       const std::vector<ValueRange>& ranges,
                                       const std::vector<std::vector<std::string>>& settings,
                                       const std::vector<double>& scores);

struct HeldOutVerdict {
  std::size_t method = 0;  ///< index into what was given
  double p = 1;            ///< by Holm's method over the candidates
  double share = 0;        ///< of the logs on which it is better than the default, ties half
  bool is_better = false, is_worse = false;  ///< significantly
};
/// values[0] is the default's on the held-out logs, values[m] those of the candidates, the best in training first; settings: of
/// the logs, as wilcoxonSignedRank() has strata. The first candidate that is better than the default, by the paired
/// signed-rank test at 5 % with Holm's method over the candidates; where none is, the first. REQUIRES a candidate
/// (ContractError).
HeldOutVerdict heldOutVerdict(const std::vector<std::vector<double>>& values, stats::Better better,
                              const std::vector<std::size_t>& settings);

struct TuneResult {
  report::Table candidates, sensitivity, held_out;
  std::string verdict;  ///< one line
  std::string tuned_path;
  bool is_better = false;         ///< than the default on the held-out worlds, significantly
  std::vector<std::string> lost;  ///< cells that could not be finished: --resume tries them again
};

/// Tunes a method by successive halving (Jamieson and Talwalkar, AISTATS 2016; seeds are the resource) and judges the
/// result where it was not tuned. Candidates are the method as it is ("default") and draws of all parameters of [tune.parameters]
/// (of the suite, else of configs/tune/METHOD.ini: `section.key = LOW..HIGH[:log]` or a list), by the stream "tune". On each
/// rung they are ranked by the suite's metric on every log of the training worlds with seeds 1, 2, ...; a failed run is worse
/// than any other, and the mean rank over the logs counts, so that no world outweighs the others. Those on the last
/// rung (three at most) then meet the default on the held-out worlds, with seeds from 1001 on: heldOutVerdict(), once. Where
/// the default itself was first in training nothing is judged.
/// Worlds, lidars, odometry, strategies, faults, limits and failure_ate_m are the suite's; its methods, logs and seeds are
/// not used. Writes into `output`:
///   METHOD_tuned.ini          the chosen candidate's configuration, whatever the verdict; its head says how sure it is
///   candidates.txt .csv .json      every candidate: its parameters, how far it came, its mean rank on each rung
///   sensitivity.txt .csv .json     on the first rung, that all candidates share
///   verdict.txt
///   training/, held_out/      sweeps (sweep()), the latter with mergeSweep()'s tables
/// Same suite, budget, seed and code: the same bytes (but for cost and manifests); --resume goes on. Errors: InputError
/// (no or unknown worlds in [tune], a world on both sides, no parameters, a budget that is too small), IoError, Interrupted.
TuneResult tune(const TuneRequest& request, const core::Manifest& manifest, core::Progress& progress);

}  // namespace slam::study
