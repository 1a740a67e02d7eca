#include "libslam/world/region.h"

#include <algorithm>

namespace slam::world {
namespace {

/// The first run of the region so far; shortens the way there for the next one who asks.
size_t rootOf(std::vector<RegionRun>& runs, size_t run) {
  while (runs[run].region != run) run = runs[run].region = runs[runs[run].region].region;
  return run;
}

void join(std::vector<RegionRun>& runs, size_t a, size_t b) {
  a = rootOf(runs, a), b = rootOf(runs, b);
  runs[std::max(a, b)].region = std::min(a, b);
}

}  // namespace

std::vector<RegionRun> regionRuns(int columns, const std::vector<char>& marked) {
  const auto width = static_cast<size_t>(columns);
  std::vector<RegionRun> runs;
  size_t below = 0;  // the first run that may touch the current one from the row below
  for (size_t row = 0; row < marked.size(); row += width) {
    for (size_t i = row; i < row + width; ++i) {
      if (!marked[i]) continue;
      const size_t begin = i;
      while (i < row + width && marked[i]) ++i;
      const size_t run = runs.size();
      runs.push_back({begin, i, run});
      while (below < run && runs[below].end + width <= begin) ++below;
      for (size_t other = below; other < run && runs[other].begin + width < i; ++other)
        join(runs, other, run);
    }
  }
  for (size_t run = 0; run < runs.size(); ++run) runs[run].region = rootOf(runs, run);
  return runs;
}

size_t largestRegionOf(const std::vector<RegionRun>& runs) {
  std::vector<size_t> cells(runs.size(), 0);
  for (const RegionRun& run : runs) cells[run.region] += run.end - run.begin;
  return static_cast<size_t>(std::max_element(cells.begin(), cells.end()) - cells.begin());
}

std::vector<size_t> largestRegion(int columns, const std::vector<char>& marked) {
  const std::vector<RegionRun> runs = regionRuns(columns, marked);
  std::vector<size_t> indices;
  if (runs.empty()) return indices;
  const size_t largest = largestRegionOf(runs);
  for (const RegionRun& run : runs)
    for (size_t i = run.begin; run.region == largest && i < run.end; ++i) indices.push_back(i);
  return indices;
}

}  // namespace slam::world
