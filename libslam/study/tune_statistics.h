#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "libslam/stats/paired.h"
#include "libslam/study/value_range.h"

namespace slam::study {

/// One rung of successive halving.
struct TuneRung {
  std::size_t candidates, seeds;
};
/// The largest schedule within a budget of runs: on every rung `reduction` times the seeds of the one before,
/// and of the candidates the best 1 / reduction (rounded up), until three or fewer are left. Runs of a rung
/// that the one before has made are not made again. Errors: InputError with the least budget (three
/// candidates, one seed).
std::vector<TuneRung> tuneSchedule(std::size_t budget, std::size_t logs_per_seed, std::size_t reduction);

/// How much a parameter matters.
struct Sensitivity {
  std::string key;
  double share =
      0;  ///< of the variance of the mean rank that it explains, less chance (stats::explainedVariance())
  double p = 1;      ///< by Holm's method over the parameters
  std::string best;  ///< the third of the drawn values (or the value of a list) with the best mean rank
};
/// settings[c] of candidate c: one text per key, in the order of keys; scores[c]: small is good. Numbers are
/// put into thirds of equal size. With fewer than 6 candidates nothing is known: share 0, p 1.
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
/// values[0] is the default's on the held-out logs, values[m] those of the candidates, the best in training
/// first; settings: of the logs, as wilcoxonSignedRank() has strata. The first candidate that is better than
/// the default, by the paired signed-rank test at 5 % with Holm's method over the candidates; where none is,
/// the first. REQUIRES a candidate (ContractError).
HeldOutVerdict heldOutVerdict(const std::vector<std::vector<double>>& values, stats::Better better,
                              const std::vector<std::size_t>& settings);

}  // namespace slam::study
