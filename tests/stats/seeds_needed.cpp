#include "libslam/stats/seeds_needed.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/stats/paired.h"

namespace slam::stats {
namespace {

using Answer = SeedsNeeded::Answer;

TEST(SeedsNeeded, FollowTheFormulaByHand) {
  // Mean 0.5, standard deviation sqrt(1 + 1/3): ((1.959964 + 0.841621) * 1.154701 / 0.5)^2 * pi / 3 = 43.84,
  // so 44.
  const std::vector<double> differences = {1.5, -0.5, 1.5, -0.5};
  const auto needed = moreSeedsNeeded(differences);
  EXPECT_EQ(needed.answer, Answer::kMore);
  EXPECT_EQ(needed.more, 40U);
  // The sign of the difference does not matter.
  EXPECT_EQ(moreSeedsNeeded({-1.5, 0.5, -1.5, 0.5}).more, 40U);
  EXPECT_GT(moreSeedsNeeded(differences, 0.01).more, 40U);
  EXPECT_GT(moreSeedsNeeded(differences, 0.05, 0.95).more, 40U);
}

TEST(SeedsNeeded, NeverGoBelowWhatTheTestNeedsAtAll) {
  const auto needed = moreSeedsNeeded({1, 1, 1});
  EXPECT_EQ(needed.answer, Answer::kMore);
  EXPECT_EQ(needed.more, 3U);  // 2^-5 is the first p that is at most 0.05
  EXPECT_EQ(moreSeedsNeeded({1, 1, 1, 1, 1, 1}).answer, Answer::kEnough);
}

TEST(PairsNeeded, AreTheFewestThatReachALevelIfAllAgree) {
  for (const double alpha : {0.05, 0.01, 0.05 / 7}) {
    const std::size_t fewest = pairsNeeded(alpha);
    const auto p = [](std::size_t count) {
      return wilcoxonSignedRank(std::vector<double>(count, 1), std::vector<double>(count, 0)).p;
    };
    EXPECT_LE(p(fewest), alpha);
    EXPECT_GT(p(fewest - 1), alpha);
  }
  EXPECT_THROW(pairsNeeded(0), core::ContractError);
}

TEST(SeedsNeeded, SayWhenNoNumberIsEnoughOrNothingIsKnown) {
  EXPECT_EQ(moreSeedsNeeded({1, -1}).answer, Answer::kNoFiniteNumber);
  EXPECT_EQ(moreSeedsNeeded({0, 0, 0}).answer, Answer::kNoFiniteNumber);
  EXPECT_EQ(moreSeedsNeeded({1, -1, 1e-4, 1e-4}).answer, Answer::kNoFiniteNumber);
  EXPECT_EQ(moreSeedsNeeded({1}).answer, Answer::kUnknown);
  EXPECT_EQ(moreSeedsNeeded({1, std::numeric_limits<double>::infinity()}).answer, Answer::kUnknown);
  EXPECT_THROW(moreSeedsNeeded({}), core::ContractError);
  EXPECT_THROW(moreSeedsNeeded({1, std::nan("")}), core::ContractError);
  EXPECT_THROW(moreSeedsNeeded({1, 2}, 0), core::ContractError);
  EXPECT_THROW(moreSeedsNeeded({1, 2}, 0.05, 1), core::ContractError);
}

// The plan kept: at the planned number the test finds normal differences about as often as `power` says.
TEST(SeedsNeeded, KeepTheirPowerForNormalDifferences) {
  core::RandomStream random(11, "power");
  constexpr int kSeeds = 33, kTrials = 2000;  // ceil((2.801585 / 0.5)^2 * pi / 3)
  int found = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<double> differences;
    differences.reserve(kSeeds);
    for (int i = 0; i < kSeeds; ++i) differences.push_back(0.5 + random.normal());
    found += wilcoxonSignedRank(differences, std::vector<double>(kSeeds)).p <= 0.05 ? 1 : 0;
  }
  EXPECT_NEAR(static_cast<double>(found) / kTrials, 0.8, 0.03);  // three standard errors
}

}  // namespace
}  // namespace slam::stats
