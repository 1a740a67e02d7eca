#include "libslam/world/region.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "libslam/core/random.h"

namespace slam::world {
namespace {

/// The twin: floods from every cell in turn.
std::vector<size_t> largestByFlooding(int columns, std::vector<char> marked) {
  const auto width = static_cast<size_t>(columns);
  std::vector<size_t> largest;
  for (size_t seed = 0; seed < marked.size(); ++seed) {
    if (!marked[seed]) continue;
    std::vector<size_t> region = {seed};
    marked[seed] = 0;
    for (size_t done = 0; done < region.size(); ++done) {
      const size_t i = region[done];
      const auto add = [&](bool exists, size_t other) {
        if (exists && marked[other]) marked[other] = 0, region.push_back(other);
      };
      add(i % width > 0, i - 1), add(i % width + 1 < width, i + 1);
      add(i >= width, i - width), add(i + width < marked.size(), i + width);
    }
    if (region.size() > largest.size()) largest = region;
  }
  std::sort(largest.begin(), largest.end());
  return largest;
}

TEST(LargestRegion, IsWhatFloodingFinds) {
  core::RandomStream random(1, "regions");
  for (int i = 0; i < 300; ++i) {
    const int columns = 1 + static_cast<int>(random.below(12)), rows = 1 + static_cast<int>(random.below(12));
    const double share = random.uniform();  // from nothing to everything
    std::vector<char> marked(static_cast<size_t>(columns) * rows);
    for (char& cell : marked) cell = random.chance(share);
    ASSERT_EQ(largestRegion(columns, marked), largestByFlooding(columns, marked)) << "case " << i;
  }
}

TEST(LargestRegion, IsEmptyWhereNothingIsMarked) {
  EXPECT_TRUE(largestRegion(3, std::vector<char>(9, 0)).empty());
  EXPECT_TRUE(largestRegion(3, {}).empty());
}

TEST(LargestRegion, IsTheFirstOfEquals) {
  EXPECT_EQ(largestRegion(3, {1, 0, 1, 1, 0, 1}), (std::vector<size_t>{0, 3}));
}

TEST(RegionRuns, DoNotGoRoundTheEdge) {
  const std::vector<RegionRun> runs = regionRuns(2, {0, 1, 1, 0});
  ASSERT_EQ(runs.size(), 2U);
  EXPECT_NE(runs[0].region, runs[1].region);
}

}  // namespace
}  // namespace slam::world
