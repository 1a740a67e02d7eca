#pragma once
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "libslam/stats/paired.h"

namespace slam::stats {

struct RankedMethod {
  std::size_t method = 0;  ///< index into what was given
  double median = 0;       ///< infinite where half of the runs or more failed
  double mean_rank = 0;    ///< over the seeds: 1 is best, equal values share a rank
  std::string letters;     ///< of compactLetters(): methods that share none are told apart
};

struct PairComparison {
  std::size_t first = 0, second = 0;  ///< indices into what was given, first < second
  double p = 1;                       ///< of wilcoxonSignedRank()
  double adjusted_p = 1;              ///< by holm() over all pairs
};

struct Ranking {
  std::vector<RankedMethod> methods;  ///< the best first: by median, then by mean rank, then as given
  std::vector<PairComparison> pairs;  ///< every pair, in the order given
};

/// Each method's mean rank over the seeds, 1 the best, equal values share a rank. values_of_methods and
/// REQUIRES as rankingGroups(). Cost: methods squared times seeds.
std::vector<double> meanRanks(const std::vector<std::vector<double>>& values_of_methods, Better better);

/// The compact display of which of `count` things, best first, are different: two of them share a letter if
/// and only if their pair is not in `different`. "a", "ab", "b"; the best has an "a"; after z comes A to Z,
/// then (53), (54) and so on. Piepho, Journal of Computational and Graphical Statistics 13(2), 2004: insert
/// and absorb, without the sweep that would drop redundant letters. REQUIRES pairs of two different indices
/// below count (ContractError).
std::vector<std::string> compactLetters(std::size_t count,
                                        const std::vector<std::pair<std::size_t, std::size_t>>& different);

/// Ranks methods by their values on the same seeds: values_of_methods[m][s] is method m's on seed s; a failed
/// run is failedValue(better). Two methods are told apart where Holm's p-value of their signed-rank test is
/// at most alpha. strata: of each seed, as wilcoxonSignedRank() has them. No methods: an empty ranking; one:
/// letter "a". REQUIRES as many values for each method, at least one, none NaN, alpha in (0, 1)
/// (ContractError).
Ranking rankingGroups(const std::vector<std::vector<double>>& values_of_methods, Better better,
                      double alpha = 0.05, const std::vector<std::size_t>& strata = {});

}  // namespace slam::stats
