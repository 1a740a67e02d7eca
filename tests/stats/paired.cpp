#include "libslam/stats/paired.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::stats {
namespace {

using core::kInfinity;
using core::kNaN;

// Nine patients' depression factor before and after a tranquilizer: Hollander and Wolfe, Nonparametric
// Statistical Methods, table 3.1.
const std::vector<double> kBefore = {1.83, 0.50, 1.62, 2.48, 1.68, 1.88, 1.55, 3.06, 1.30};
const std::vector<double> kAfter = {0.878, 0.647, 0.598, 2.05, 1.06, 1.29, 1.06, 3.14, 1.29};

std::vector<double> zeros(const std::vector<double>& like) {
  return std::vector<double>(like.size());
}

/// The signed-rank test as its definition reads: all 2^n signs, ranks by counting.
double bruteForceP(const std::vector<double>& differences) {
  std::vector<double> ranks;
  double above = 0, total = 0;
  for (const double d : differences) {
    if (d == 0) continue;
    double rank = 0.5;
    for (const double other : differences)
      rank += std::abs(other) < std::abs(d) ? 1 : std::abs(other) == std::abs(d) ? 0.5 : 0;
    ranks.push_back(rank);
    total += rank;
    if (d > 0) above += rank;
  }
  const double off = std::abs(above - total / 2);
  int as_clear = 0;
  for (unsigned signs = 0; signs < (1U << ranks.size()); ++signs) {
    double sum = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i)
      if ((signs >> i & 1U) != 0) sum += ranks[i];
    as_clear += std::abs(sum - total / 2) >= off ? 1 : 0;
  }
  return static_cast<double>(as_clear) / static_cast<double>(1U << ranks.size());
}

TEST(SignedRank, GivesHollanderAndWolfesDepressionExample) {
  const auto test = wilcoxonSignedRank(kBefore, kAfter);
  EXPECT_EQ(test.statistic, 40);
  EXPECT_EQ(test.pairs, 9U);
  EXPECT_TRUE(test.is_exact);
  EXPECT_DOUBLE_EQ(test.p, 20.0 / 512);  // one-sided 0.019531 there
}

TEST(SignedRank, GivesDarwinsMaizeExample) {
  // Heights of crossed minus self-fertilised plants, eighths of an inch (Fisher, The Design of Experiments,
  // 1935); W- = 24 and p = 0.041259765625 in SciPy's manual, scipy.stats.wilcoxon.
  const std::vector<double> differences = {6, 8, 14, 16, 23, 24, 28, 29, 41, -48, 49, 56, 60, -67, 75};
  const auto test = wilcoxonSignedRank(zeros(differences), differences);
  EXPECT_EQ(test.statistic, 24);
  EXPECT_DOUBLE_EQ(test.p, 0.041259765625);
}

TEST(SignedRank, EqualsTheCountOfAllSignsWithTiesAndZeros) {
  core::RandomStream random(1, "signed-rank");
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> differences(1 + random.below(12));
    for (double& d : differences) d = static_cast<double>(random.below(9)) - 3;  // many ties, some zeros
    // Counts over a power of two: both are exact.
    EXPECT_EQ(wilcoxonSignedRank(differences, zeros(differences)).p, bruteForceP(differences)) << trial;
  }
}

TEST(SignedRank, RanksEqualPairsAndThenLeavesThemOut) {
  // Pratt's way: ranks 2, 3 and 4 remain, all above, one of 8 sign patterns on each side.
  const auto test = wilcoxonSignedRank({5, 6, 7, 8}, {5, 5, 5, 5});
  EXPECT_EQ(test.statistic, 9);
  EXPECT_EQ(test.pairs, 3U);
  EXPECT_EQ(test.ties, 1U);
  EXPECT_DOUBLE_EQ(test.p, 0.25);
}

TEST(SignedRank, IsNormalForManyPairsWithACorrection) {
  // Ranks 1 to 60; 600 of 1830 below: (915 - 600 - 1/2) / sqrt(60 * 61 * 121 / 24) = 2.315217.
  std::vector<double> differences;
  double below = 0;
  for (int rank = 60; rank >= 1; --rank) {
    const bool is_below = below + rank <= 600;
    below += is_below ? rank : 0;
    differences.push_back(is_below ? -rank : rank);
  }
  ASSERT_EQ(below, 600);
  const auto test = wilcoxonSignedRank(differences, zeros(differences));
  EXPECT_FALSE(test.is_exact);
  EXPECT_NEAR(test.p, std::erfc(2.315217 / std::sqrt(2)), 1e-6);
}

TEST(SignedRank, HasNoStepWhereTheNormalApproximationBegins) {
  core::RandomStream random(3, "step");
  std::vector<double> differences(50);
  for (double& d : differences) d = 0.3 + random.normal();
  const double exact = wilcoxonSignedRank(differences, zeros(differences)).p;
  differences.push_back(1e-9);  // rank 1 moves the statistic by its expectation and a half
  const auto normal = wilcoxonSignedRank(differences, zeros(differences));
  EXPECT_FALSE(normal.is_exact);
  EXPECT_NEAR(normal.p / exact, 1, 0.1);
}

TEST(SignedRank, IsTheSameTheOtherWayRound) {
  const auto one = wilcoxonSignedRank(kBefore, kAfter), other = wilcoxonSignedRank(kAfter, kBefore);
  EXPECT_EQ(one.p, other.p);
  EXPECT_EQ(one.statistic + other.statistic, 45);
}

TEST(SignedRank, RanksAFailedRunWorstAndTwoFailuresEqual) {
  // Differences -1, -2 and minus infinity, and a pair of failures.
  const auto test = wilcoxonSignedRank({1, 2, 3, kInfinity}, {2, 4, kInfinity, kInfinity});
  EXPECT_EQ(test.ties, 1U);
  EXPECT_EQ(test.statistic, 0);
  EXPECT_DOUBLE_EQ(test.p, 0.25);
  // Where one failure each way weighs the same: ranks 3.5 and 3.5 against 1 and 2.
  EXPECT_EQ(wilcoxonSignedRank({kInfinity, 1, 5, 7}, {1, kInfinity, 4, 5}).statistic, 6.5);
}

TEST(SignedRank, RanksWithinStrata) {
  const std::vector<double> a = {1, 2, 0, 20}, b = {0, 0, 10, 0};
  // All together: ranks 1, 2, 3, 4 and the third below: of 16 sign patterns 5 have a sum of 3 or less.
  EXPECT_DOUBLE_EQ(wilcoxonSignedRank(a, b).p, 2 * 5.0 / 16);
  // Two by two: ranks 1, 2 and 1, 2, the third pair's is 1: sums of 1 or less are {}, {1}, {1}.
  const auto test = wilcoxonSignedRank(a, b, {0, 0, 1, 1});
  EXPECT_DOUBLE_EQ(test.p, 2 * 3.0 / 16);
  EXPECT_DOUBLE_EQ(test.statistic, 5);
  EXPECT_DOUBLE_EQ(wilcoxonSignedRank(b, a, {0, 0, 1, 1}).p, test.p);
  EXPECT_DOUBLE_EQ(wilcoxonSignedRank(a, b, {7, 7, 7, 7}).p, wilcoxonSignedRank(a, b).p);
  // One by one every rank is 1: the sign test.
  EXPECT_DOUBLE_EQ(wilcoxonSignedRank(a, b, {0, 1, 2, 3}).p, signTest(a, b).p);
  EXPECT_THROW(wilcoxonSignedRank(a, b, {0, 1}), core::ContractError);
}

TEST(SignedRank, IsOneWhereNothingDiffers) {
  EXPECT_EQ(wilcoxonSignedRank({1, 2}, {1, 2}).p, 1);
  EXPECT_EQ(wilcoxonSignedRank({1}, {2}).p, 1);
}

TEST(PairedTests, RefuseWhatIsNotPaired) {
  EXPECT_THROW(wilcoxonSignedRank({}, {}), core::ContractError);
  EXPECT_THROW(wilcoxonSignedRank({1, 2}, {1}), core::ContractError);
  EXPECT_THROW(wilcoxonSignedRank({1, kNaN}, {1, 2}), core::ContractError);
  EXPECT_THROW(signTest({}, {}), core::ContractError);
  EXPECT_THROW(signTest({1}, {kNaN}), core::ContractError);
  EXPECT_THROW(probabilityOfImprovement({1}, {}, Better::kSmaller), core::ContractError);
  EXPECT_THROW(probabilityOfSuperiority({1}, {}, Better::kSmaller), core::ContractError);
}

TEST(SignTest, CountsDepressionPatientsByHand) {
  const auto test = signTest(kBefore, kAfter);  // 7 of 9: 2 (1 + 9 + 36) / 512
  EXPECT_EQ(test.statistic, 7);
  EXPECT_NEAR(test.p, 92.0 / 512, 1e-14);
}

TEST(SignTest, LeavesEqualPairsOut) {
  const auto test = signTest({1, 2, 3, 4, 9}, {2, 3, 4, 5, 9});
  EXPECT_EQ(test.pairs, 4U);
  EXPECT_EQ(test.ties, 1U);
  EXPECT_NEAR(test.p, 0.125, 1e-14);
  EXPECT_EQ(signTest({1}, {1}).p, 1);
  EXPECT_EQ(signTest({1, 3}, {2, 2}).p, 1);  // both tails hold the middle: not above 1
}

TEST(Improvement, CountsPairsAndHalvesTies) {
  const auto estimate = probabilityOfImprovement({1, 1, 5, 3}, {2, 2, 5, 1}, Better::kSmaller);
  EXPECT_DOUBLE_EQ(estimate.value, 2.5 / 4);
  EXPECT_LT(estimate.interval->low, 0.5);
  EXPECT_EQ(estimate.interval->high, 1);
  const auto other = probabilityOfImprovement({2, 2, 5, 1}, {1, 1, 5, 3}, Better::kSmaller);
  EXPECT_DOUBLE_EQ(other.value, 1 - estimate.value);
  EXPECT_NEAR(other.interval->low, 1 - estimate.interval->high, 1e-12);
  EXPECT_DOUBLE_EQ(probabilityOfImprovement({1, 1, 5, 3}, {2, 2, 5, 1}, Better::kLarger).value, 1.5 / 4);
}

TEST(Improvement, IsNotCertainBecauseTenSeedsAgree) {
  const std::vector<double> a(10, 1), b(10, 2);
  const auto better = probabilityOfImprovement(a, b, Better::kSmaller);
  EXPECT_EQ(better.value, 1);
  EXPECT_NEAR(better.interval->low, 1 - 0.3085, 5e-5);
  EXPECT_EQ(better.interval->high, 1);
  EXPECT_NEAR(probabilityOfImprovement(a, b, Better::kLarger).interval->high, 0.3085, 5e-5);
  EXPECT_FALSE(probabilityOfImprovement(a, a, Better::kLarger).interval);
}

TEST(Superiority, ComparesEveryValueWithEvery) {
  // 1 beats 2, 3, 3; 3 ties 3 twice: (3 + 2/2) / 6.
  EXPECT_DOUBLE_EQ(probabilityOfSuperiority({1, 3}, {2, 3, 3}, Better::kSmaller), 4.0 / 6);
  EXPECT_DOUBLE_EQ(probabilityOfSuperiority({1, 3}, {2, 3, 3}, Better::kLarger), 2.0 / 6);
  EXPECT_EQ(probabilityOfSuperiority({kInfinity}, {kInfinity}, Better::kSmaller), 0.5);
  EXPECT_EQ(probabilityOfSuperiority({failedValue(Better::kLarger)}, {0.0}, Better::kLarger), 0);
}

}  // namespace
}  // namespace slam::stats
