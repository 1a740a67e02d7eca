#pragma once
#include <cstddef>
#include <vector>

#include "libslam/stats/estimate.h"

namespace slam::stats {

// Two methods on the same seeds: a[i] and b[i] belong together. Here a run that failed is an infinite value:
// +infinity where small is good, -infinity where large is good (failedValue()). It is then worse than every
// value and as bad as another failure. All of this: REQUIRES as many values in a as in b, at least one, none
// NaN (ContractError).

enum class Better { kSmaller, kLarger };
/// What stands for a run that failed.
double failedValue(Better better);

struct PairedTest {
  double p = 1;           ///< two-sided: how often chance alone gives a difference as clear as this one
  std::size_t pairs = 0;  ///< of which a and b differ
  std::size_t ties = 0;   ///< pairs of equal values
  double statistic = 0;   ///< what the test counts, for a above b: ranks (signed-rank), pairs (sign)
  bool is_exact = true;   ///< not the normal approximation
};

/// Wilcoxon's signed-rank test (Biometrics Bulletin 1(6), 1945) of differences that are symmetric about zero.
/// Equal differences share their mean rank; pairs that are equal are ranked too and then left out (Pratt,
/// JASA 54, 1959), so they make a difference less clear. Differences with a failed run rank above all others.
/// Up to 50 pairs the distribution is exact, given the ranks as they are, ties and zeros included; above,
/// normal with the variance of these ranks and a continuity correction (Hollander, Wolfe and Chicken,
/// Nonparametric Statistical Methods, 3rd ed. 2014, section 3.1). p is the doubled smaller tail, at most 1;
/// without any difference 1. Of n pairs it is never below 2^(1-n): under 6 pairs nothing reaches 0.05.
/// wilcoxonSignedRank(b, a) has the same p.
/// With `strata` (of each pair the one that it was measured in, any numbers; none: all in one) differences
/// are ranked within their stratum, and the ranks of all are summed: a building in which errors are large
/// does not drown the others, as van Elteren's test has it for samples that are not paired (Bulletin de
/// l'Institut International de Statistique 37, 1960). The hypothesis is then that in no stratum either is
/// better. REQUIRES strata for all pairs or none (ContractError).
PairedTest wilcoxonSignedRank(const std::vector<double>& a, const std::vector<double>& b,
                              const std::vector<std::size_t>& strata = {});

/// The sign test: binomial, exact for any number of pairs; equal pairs are left out (Hollander, Wolfe and
/// Chicken, section 3.4). It asks for no symmetry and sees less.
PairedTest signTest(const std::vector<double>& a, const std::vector<double>& b);

/// The share of pairs in which a is better than b, equal pairs counting half, with meanInterval() over the
/// pairs, which are drawn within their `strata` (of each pair the one that it was measured in; none: all in
/// one). Where every pair says the same (a better in all, or in none) nothing varies and the interval is that
/// of clopperPearson(); where all are equal there is none. Of (b, a) it is one minus this. REQUIRES
/// confidence in (0, 1) (ContractError).
Estimate probabilityOfImprovement(const std::vector<double>& a, const std::vector<double>& b, Better better,
                                  const std::vector<std::size_t>& strata = {}, double confidence = 0.95);

/// For samples that are not paired: the chance that a value of a is better than one of b, ties half (the A
/// measure of Vargha and Delaney, Journal of Educational and Behavioral Statistics 25(2), 2000). The only
/// function here for which a and b may differ in length.
double probabilityOfSuperiority(const std::vector<double>& a, const std::vector<double>& b, Better better);

}  // namespace slam::stats
