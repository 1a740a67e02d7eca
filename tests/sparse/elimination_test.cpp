#include "libslam/sparse/elimination.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "libslam/core/random.h"

namespace slam::sparse {
namespace {

using Entries = std::vector<std::pair<int, int>>;

Entries randomEntries(int size, int count, std::uint64_t seed) {
  core::RandomStream random(seed, "entries");
  const auto any = [&] { return static_cast<int>(random.below(static_cast<std::uint64_t>(size))); };
  std::set<std::pair<int, int>> known;
  while (static_cast<int>(known.size()) < count) {
    const int a = any(), b = any();
    if (a != b && !known.count({b, a})) known.emplace(a, b);
  }
  return {known.begin(), known.end()};
}

/// Rows below the diagonal of each column, by eliminating one after the other, in the order given.
std::vector<std::set<int>> eliminated(const Elimination& order, const Entries& entries) {
  std::vector<std::set<int>> columns(static_cast<size_t>(order.size()));
  for (const auto& [a, b] : entries) {
    const int row = std::max(order.position(a), order.position(b)),
              column = std::min(order.position(a), order.position(b));
    columns[static_cast<size_t>(column)].insert(row);
  }
  for (auto& column : columns) {
    if (column.empty()) continue;
    auto& next = columns[static_cast<size_t>(*column.begin())];
    next.insert(std::next(column.begin()), column.end());
  }
  return columns;
}

TEST(Elimination, SupernodesHoldEveryEntryOfTheFactor) {
  for (const std::uint64_t seed : {1, 2, 3, 4}) {
    const Entries entries = randomEntries(60, 40 * static_cast<int>(seed), seed);
    const Elimination elimination(60, entries);
    const auto columns = eliminated(elimination, entries);
    long count = 0;
    for (int k = 0; k < 60; ++k) {
      const int s = elimination.supernodeOf(k);
      const auto& supernode = elimination.supernode(s);
      ASSERT_GE(k, supernode.first);
      ASSERT_LT(k, supernode.first + supernode.width);
      for (const int row : columns[static_cast<size_t>(k)]) {
        const int place = elimination.placeIn(s, row);
        if (row < supernode.first + supernode.width)
          EXPECT_EQ(place, row - supernode.first);
        else
          EXPECT_EQ(elimination.rows()[static_cast<size_t>(supernode.rows_begin + place - supernode.width)],
                    row);
      }
      count += static_cast<long>(columns[static_cast<size_t>(k)].size());
    }
    EXPECT_EQ(elimination.entries(), count);
  }
}

TEST(Elimination, UpdatesNameEveryRowBelowOnceAndWhereItLies) {
  const Elimination elimination(80, randomEntries(80, 200, 9));
  for (const auto& supernode : elimination.supernodes()) {
    int next = 0;
    for (int u = supernode.updates_begin; u < supernode.updates_end; ++u) {
      const auto& update = elimination.updates()[static_cast<size_t>(u)];
      EXPECT_EQ(update.from, next);
      next = update.to;
      for (int i = update.from; i < supernode.below(); ++i) {
        const int at_row = supernode.rows_begin + i;
        const int row = elimination.rows()[static_cast<size_t>(at_row)];
        EXPECT_EQ(elimination.supernodeOf(row) == update.target, i < update.to);
        EXPECT_EQ(elimination.places()[static_cast<size_t>(update.places_begin + i - update.from)],
                  elimination.placeIn(update.target, row));
      }
    }
    EXPECT_EQ(next, supernode.below());
  }
}

TEST(Elimination, AFullMatrixIsOneSupernode) {
  Entries all;
  for (int a = 0; a < 12; ++a)
    for (int b = 0; b < a; ++b) all.emplace_back(a, b);
  const Elimination elimination(12, all);
  ASSERT_EQ(elimination.supernodes().size(), 1U);
  EXPECT_EQ(elimination.supernode(0).width, 12);
  EXPECT_EQ(elimination.entries(), 66);
}

TEST(Elimination, WhatIsNotTiedTogetherStaysApart) {
  const Elimination elimination(6, {{0, 1}, {1, 2}, {3, 4}, {4, 5}});
  EXPECT_EQ(elimination.entries(), 4);
  std::set<int> order;
  for (int k = 0; k < 6; ++k) {
    order.insert(elimination.rowAt(k));
    EXPECT_EQ(elimination.position(elimination.rowAt(k)), k);
  }
  EXPECT_EQ(order.size(), 6U);
  EXPECT_EQ(Elimination(0, {}).size(), 0);
  EXPECT_EQ(Elimination(1, {}).supernodes().size(), 1U);
}

}  // namespace
}  // namespace slam::sparse
