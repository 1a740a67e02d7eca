#include "libslam/stats/ranking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libslam/core/error.h"
#include "libslam/core/random.h"

namespace slam::stats {
namespace {

using testing::ElementsAre;
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

bool shareALetter(const std::string& a, const std::string& b) {
  return a.find_first_of(b) != std::string::npos;
}

TEST(CompactLetters, ShowOverlappingGroups) {
  EXPECT_THAT(compactLetters(3, {}), ElementsAre("a", "a", "a"));
  EXPECT_THAT(compactLetters(3, {{0, 2}}), ElementsAre("a", "ab", "b"));
  EXPECT_THAT(compactLetters(3, {{0, 1}, {0, 2}, {1, 2}}), ElementsAre("a", "b", "c"));
  EXPECT_THAT(compactLetters(4, {{2, 0}, {0, 3}, {1, 3}}), ElementsAre("a", "ab", "bc", "c"));
  EXPECT_THAT(compactLetters(1, {}), ElementsAre("a"));
  EXPECT_TRUE(compactLetters(0, {}).empty());
}

TEST(CompactLetters, AreSharedIfAndOnlyIfAPairIsNotDifferent) {
  core::RandomStream random(5, "letters");
  for (int trial = 0; trial < 100; ++trial) {
    const std::size_t count = 2 + random.below(7);
    Pairs different;
    std::set<std::pair<std::size_t, std::size_t>> is_different;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = i + 1; j < count; ++j)
        if (random.chance(0.5)) {
          different.emplace_back(i, j);
          is_different.emplace(i, j);
        }
    const auto letters = compactLetters(count, different);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = i + 1; j < count; ++j)
        EXPECT_EQ(shareALetter(letters[i], letters[j]), is_different.count({i, j}) == 0) << trial;
    EXPECT_NE(letters[0].find('a'), std::string::npos);
  }
}

TEST(CompactLetters, GoOnBehindTheAlphabet) {
  Pairs all;
  for (std::size_t i = 0; i < 54; ++i)
    for (std::size_t j = i + 1; j < 54; ++j) all.emplace_back(i, j);
  const auto letters = compactLetters(54, all);
  EXPECT_EQ(letters[25], "z");
  EXPECT_EQ(letters[26], "A");
  EXPECT_EQ(letters[53], "(54)");
  EXPECT_THROW(compactLetters(2, {{0, 2}}), core::ContractError);
  EXPECT_THROW(compactLetters(2, {{1, 1}}), core::ContractError);
}

TEST(Ranking, TellsApartWhatTenSeedsTellApart) {
  std::vector<double> good, equal, bad;
  for (int seed = 0; seed < 10; ++seed) {
    good.push_back(1 + 0.1 * seed);
    equal.push_back(good.back() + (seed % 2 == 0 ? 0.01 : -0.012));
    bad.push_back(2 + 0.13 * seed);
  }
  const auto ranking = rankingGroups({bad, good, equal}, Better::kSmaller);
  ASSERT_EQ(ranking.methods.size(), 3U);
  EXPECT_EQ(ranking.methods[2].method, 0U);
  EXPECT_EQ(ranking.methods[0].letters, "a");
  EXPECT_EQ(ranking.methods[1].letters, "a");
  EXPECT_EQ(ranking.methods[2].letters, "b");
  EXPECT_EQ(ranking.methods[2].mean_rank, 3);
  EXPECT_EQ(ranking.methods[0].mean_rank + ranking.methods[1].mean_rank, 3);
  ASSERT_EQ(ranking.pairs.size(), 3U);
  EXPECT_DOUBLE_EQ(ranking.pairs[0].p, 2.0 / 1024);
  EXPECT_DOUBLE_EQ(ranking.pairs[0].adjusted_p, 6.0 / 1024);  // the smallest of three

  const auto reversed = rankingGroups({bad, good, equal}, Better::kLarger);
  EXPECT_EQ(reversed.methods[0].method, 0U);
  EXPECT_EQ(reversed.methods[0].letters, "a");
  EXPECT_EQ(reversed.methods[1].letters, "b");
}

TEST(Ranking, NeverSeparatesByFewSeeds) {
  const auto ranking = rankingGroups({{1, 1, 1, 1, 1}, {9, 9, 9, 9, 9}}, Better::kSmaller);
  EXPECT_EQ(ranking.methods[0].letters, "a");
  EXPECT_EQ(ranking.methods[1].letters, "a");
}

TEST(Ranking, PutsFailedRunsLast) {
  const double failed = failedValue(Better::kSmaller);
  const std::vector<double> sound(8, 5),
      mostly_failed = {1, 1, failed, failed, failed, failed, failed, failed};
  const auto ranking = rankingGroups({mostly_failed, sound}, Better::kSmaller);
  EXPECT_EQ(ranking.methods[0].method, 1U);
  EXPECT_TRUE(std::isinf(ranking.methods[1].median));
  // As many failures each: a tie, in the order given.
  const auto tied = rankingGroups({{failed, 1}, {1, failed}}, Better::kSmaller);
  EXPECT_EQ(tied.methods[0].method, 0U);
  EXPECT_EQ(tied.methods[0].mean_rank, 1.5);
}

TEST(Ranking, MeanRanksAreThoseOfTheGroups) {
  const double failed = failedValue(Better::kSmaller);
  EXPECT_EQ(meanRanks({{1, 2, failed}, {1, 1, 3}, {0, 3, failed}}, Better::kSmaller),
            (std::vector<double>{(2.5 + 2 + 2.5) / 3, (2.5 + 1 + 1) / 3, (1 + 3 + 2.5) / 3}));
  EXPECT_THROW(meanRanks({{1, 2}, {1}}, Better::kSmaller), core::ContractError);
}

TEST(Ranking, OfNothingAndOfOne) {
  EXPECT_TRUE(rankingGroups({}, Better::kSmaller).methods.empty());
  const auto one = rankingGroups({{3}}, Better::kSmaller);
  EXPECT_EQ(one.methods[0].letters, "a");
  EXPECT_EQ(one.methods[0].mean_rank, 1);
  EXPECT_THROW(rankingGroups({{1, 2}, {1}}, Better::kSmaller), core::ContractError);
  EXPECT_THROW(rankingGroups({{}}, Better::kSmaller), core::ContractError);
  EXPECT_THROW(rankingGroups({{1}, {std::nan("")}}, Better::kSmaller), core::ContractError);
  EXPECT_THROW(rankingGroups({{1}}, Better::kSmaller, 0), core::ContractError);
}

}  // namespace
}  // namespace slam::stats
