#include "libslam/oracle/moats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"

namespace slam::oracle {
namespace {

/// The shortest path over groups that misses at most `spare`, by trying all.
double shortest(const Places& places, double spare) {
  const std::size_t count = places.area.size();
  double best = 1e9;
  for (unsigned set = 0; set < 1U << count; ++set) {
    double missed = 0;
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < count; ++i)
      if (set >> i & 1U)
        order.push_back(i);
      else
        missed += places.area[i];
    if (missed > spare) continue;
    do {
      double length = order.empty() ? 0 : places.from_start[order.front()];
      for (std::size_t k = 1; k < order.size(); ++k) length += places.between[order[k - 1]][order[k]];
      best = std::min(best, length);
    } while (std::next_permutation(order.begin(), order.end()));
  }
  return best;
}

TEST(MoatBound, IsTheWayToOneGroupAndForthAndBackForTwo) {
  const Places one{{1000}, {5}, {{0}}};
  EXPECT_NEAR(moatBound(one, 0), 5, 1e-6);
  EXPECT_EQ(moatBound(one, 1000), 0);
  const Places two{{1000, 1000}, {5, 5}, {{0, 10}, {10, 0}}};  // one on either side
  EXPECT_NEAR(moatBound(two, 0), 15, 1e-6);
  EXPECT_GT(moatBound(two, 1), 14.9);
  EXPECT_EQ(moatBound({}, 0), 0);
}

TEST(MoatBound, IsNeverAboveTheShortestPath) {
  core::RandomStream random(5, "moats");
  double share = 0;
  constexpr int kDrawn = 60;
  for (int drawn = 0; drawn < kDrawn; ++drawn) {
    const std::size_t count = 1 + random.below(6);
    std::vector<core::Point2> at(count + 1);
    for (auto& p : at) p = {10 * random.uniform(), 10 * random.uniform()};
    Places places;
    for (std::size_t i = 0; i < count; ++i) {
      places.area.push_back(1 + 9 * random.uniform());
      places.from_start.push_back(core::distance(at[0], at[i + 1]));
      places.between.emplace_back();
      for (std::size_t j = 0; j < count; ++j)
        places.between.back().push_back(core::distance(at[i + 1], at[j + 1]));
    }
    const double spare = drawn % 2 ? 0 : 0.3 * std::accumulate(places.area.begin(), places.area.end(), 0.0);
    const double bound = moatBound(places, spare), least = shortest(places, spare);
    EXPECT_LE(bound, least + 1e-9) << "drawing " << drawn;
    if (spare == 0 && least > 0) share += 2 * bound / least / kDrawn;
  }
  EXPECT_GT(share, 0.6);  // and worth having
}

}  // namespace
}  // namespace slam::oracle
