#pragma once
#include <cstddef>
#include <vector>

namespace slam::stats {

struct SeedsNeeded {
  enum class Answer {
    kEnough,          ///< the differences at hand are significant
    kMore,            ///< `more` seeds
    kNoFiniteNumber,  ///< no difference to be seen, or so small that a million seeds would not show it
    kUnknown          ///< one value, or a failed run among them: they say nothing of the spread
  };
  Answer answer = Answer::kUnknown;
  std::size_t more = 0;
};

/// How many seeds beyond those at hand until the signed-rank test finds the paired differences significant at
/// alpha (two-sided) with probability `power`, if mean m and standard deviation s of the differences are the
/// true ones: n = ((z(1 - alpha/2) + z(power)) s / m)^2 / ARE, with ARE = 3/pi, the test's efficiency beside
/// the t-test's for normal differences (Lehmann, Nonparametrics: Statistical Methods Based on Ranks, 1975,
/// section 4.2 and appendix 7); and never fewer than pairsNeeded(). A plan, not a promise: m and s are
/// themselves estimates.
/// REQUIRES at least one difference, none NaN; alpha and power in (0, 1) (ContractError).
SeedsNeeded moreSeedsNeeded(const std::vector<double>& differences, double alpha = 0.05, double power = 0.8);

/// The fewest pairs with which wilcoxonSignedRank() can reach alpha at all, 2^(1-n) <= alpha: 6 for 0.05.
/// REQUIRES alpha in (0, 1) (ContractError).
std::size_t pairsNeeded(double alpha);

}  // namespace slam::stats
