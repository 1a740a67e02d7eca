#include "libslam/oracle/views.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <queue>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/rays/ray_walk.h"

namespace slam::oracle {
namespace {

constexpr int kRays = 1080;  // one cell and less apart up to 8 m

template <class See>
void lookRound(const world::Plan& plan, std::size_t from, double max_range_m, See see) {
  const auto columns = static_cast<std::size_t>(plan.columns);
  const std::size_t row = from / columns;
  const core::Point2 origin{static_cast<double>(from % columns) + 0.5, static_cast<double>(row) + 0.5};
  const double limit =
      max_range_m > 0 ? max_range_m / plan.resolution_m : std::numeric_limits<double>::infinity();
  bool go_on = true;
  for (int ray = 0; ray < kRays && go_on; ++ray) {
    const double angle = ray * (2 * core::kPi / kRays);
    rays::walkRay(plan, origin, {core::cos(angle), core::sin(angle)}, limit,
                  [&](const world::Cell* cell, const rays::RayEntry& entry) {
                    if (*cell == world::Cell::kOccupied || !entry.isWithin(limit)) return false;
                    go_on = see(static_cast<std::size_t>(cell - plan.cells.data()));
                    return go_on;
                  });
  }
}

/// Lowers the distances around a new view; the wave ends where another view is nearer.
void spread(const DriveGraph& graph, DriveGraph::Node from, std::int32_t view, std::vector<float>& nearest_m,
            std::vector<std::int32_t>& near) {
  const auto length_m = graph.waysFrom(from, nearest_m).length_m;
  for (std::size_t node = 0; node < length_m.size(); ++node)
    if (length_m[node] < nearest_m[node]) nearest_m[node] = length_m[node], near[node] = view;
}

std::vector<std::int32_t> sampleOfCell(const world::Plan& plan, const metrics::ExplorableArea& area,
                                       std::size_t most, std::size_t& count) {
  int stride = 1;
  while (area.cells / static_cast<std::size_t>(stride * stride) > most) ++stride;
  std::vector<std::int32_t> sample(plan.cells.size(), -1);
  count = 0;
  for (int row = stride / 2; row < plan.rows; row += stride)
    for (int column = stride / 2; column < plan.columns; column += stride) {
      const auto cell = static_cast<std::size_t>(row) * static_cast<std::size_t>(plan.columns) +
                        static_cast<std::size_t>(column);
      if (area.explorable[cell]) sample[cell] = static_cast<std::int32_t>(count++);
    }
  return sample;
}

}  // namespace

std::size_t countOf(const SampleSet& set) {
  std::size_t count = 0;
  for (const std::uint64_t word : set) count += std::bitset<64>(word).count();
  return count;
}

Views sampleViews(const world::Plan& plan, const metrics::ExplorableArea& area, const DriveGraph& graph,
                  const ViewOptions& options) {
  Views views;
  if (graph.size() == 0) return views;
  const auto sample = sampleOfCell(plan, area, options.most_samples, views.samples);
  const std::size_t words = (views.samples + 63) / 64;
  std::vector<float> nearest_m(graph.size(), std::numeric_limits<float>::infinity());
  views.near.assign(graph.size(), 0);
  const auto add = [&](DriveGraph::Node node) {
    SampleSet seen(words, 0);
    lookRound(plan, graph.cellOf(node), options.max_range_m, [&](std::size_t cell) {
      if (sample[cell] >= 0)
        seen[static_cast<std::size_t>(sample[cell]) / 64] |= std::uint64_t{1} << (sample[cell] % 64);
      return true;
    });
    spread(graph, node, static_cast<std::int32_t>(views.node.size()), nearest_m, views.near);
    views.node.push_back(node);
    views.seen.push_back(std::move(seen));
  };
  add(0);
  while (views.node.size() < options.most_views) {
    std::size_t farthest = 0;
    float most_m = 0;
    for (std::size_t node = 0; node < nearest_m.size(); ++node)
      // What no way leads to (a passage thinner than the graph's blocks) is nowhere to look from.
      if (std::isfinite(nearest_m[node]) && nearest_m[node] > most_m)
        most_m = nearest_m[node], farthest = node;
    if (static_cast<double>(most_m) < options.spacing_m) break;
    add(static_cast<DriveGraph::Node>(farthest));
  }
  SampleSet all(words, 0);
  for (const auto& seen : views.seen)
    for (std::size_t w = 0; w < words; ++w) all[w] |= seen[w];
  for (std::size_t cell = 0; cell < sample.size(); ++cell) {
    if (sample[cell] < 0) continue;
    const auto s = static_cast<std::size_t>(sample[cell]);
    if (all[s / 64] >> (s % 64) & 1) continue;
    DriveGraph::Node found = -1;
    lookRound(plan, cell, options.max_range_m, [&](std::size_t other) {
      if (!graph.isReachable(other)) return true;
      const auto node = graph.nodeAt(other);
      if (node >= 0 && std::isfinite(nearest_m[static_cast<std::size_t>(node)])) found = node;
      return found < 0;
    });
    if (found < 0) continue;
    add(found);
    for (std::size_t w = 0; w < words; ++w) all[w] |= views.seen.back()[w];
  }
  return views;
}

}  // namespace slam::oracle
