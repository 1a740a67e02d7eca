#include "libslam/navigate/next_best_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace slam::navigate {
namespace {

constexpr int kDirections = 120;
constexpr std::size_t kMostFirst = 16;  // views that are looked further from

struct View {
  std::size_t viewpoint;
  double look_rad, gain_m2, worth;
};

/// Metres from one viewpoint to another by the ways that the robot knows: back to where their ways part. The
/// straight line where that is shorter by less than the ways' own wriggling would be a guess through walls.
double lengthBetween(const Viewpoint& a, const Viewpoint& b) {
  const std::size_t most = std::min(a.way.size(), b.way.size());
  std::size_t common = 0;
  while (common < most && a.way[common] == b.way[common]) ++common;
  const auto rest = [&](const Viewpoint& v) {
    const double steps = static_cast<double>(std::max<std::size_t>(v.way.size(), 2) - 1);
    return v.length_m * static_cast<double>(v.way.size() - common) / steps;
  };
  return rest(a) + rest(b);
}

}  // namespace

std::optional<MapStrategy::Choice> NextBestView::choose(const Scene& scene) {
  const double lambda = options().lambda_per_m;
  std::vector<View> views;
  for (std::size_t i = 0; i < scene.viewpoints.size(); ++i) {
    const Viewpoint& viewpoint = scene.viewpoints[i];
    const auto profile =
        expectedGain(scene.space, viewpoint.p_map, scene.view, options().unknown_path_m, kDirections);
    const double look_rad = profile.bestHeading(scene.view);
    const double gain_m2 = profile.within(scene.view, look_rad);
    if (gain_m2 >= options().gain_min_m2)
    views.push_back({i, look_rad, gain_m2, (gain_m2 + (getenv("G0") ? atof(getenv("G0")) : 0)) * std::exp(-lambda * viewpoint.length_m)});
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const View& a, const View& b) { return a.worth > b.worth; });
  views.resize(std::min(views.size(), kMostFirst));

  std::vector<std::vector<std::pair<std::size_t, float>>> cells;
  for (const auto& view : views)
    cells.push_back(expectedCells(scene.space, scene.viewpoints[view.viewpoint].p_map, scene.view,
                                  view.look_rad, options().unknown_path_m, kDirections));
  static const double kG0 = getenv("G0") ? atof(getenv("G0")) : 0;
  std::vector<char> shown(scene.space.state.size(), 0);
  Choice best;
  best.score = -1;
  std::vector<char> used(views.size());
  for (std::size_t a = 0; a < views.size(); ++a) {
    std::fill(used.begin(), used.end(), 0);
    std::size_t here = a;
    double length_m = scene.viewpoints[views[a].viewpoint].length_m;
    double score = (views[a].gain_m2 + kG0) * std::exp(-lambda * length_m);
    const double first_worth = score;
    std::vector<std::size_t> marked;
    for (int depth = 1; depth < options().horizon; ++depth) {
      used[here] = 1;
      for (const auto& cell : cells[here]) if (!shown[cell.first]) shown[cell.first] = 1, marked.push_back(cell.first);
      double best_worth = 0, best_length = 0; std::size_t next = here;
      for (std::size_t b = 0; b < views.size(); ++b) {
        if (used[b]) continue;
        double gain_m2 = 0;
        for (const auto& [cell, area_m2] : cells[b])
          if (!shown[cell]) gain_m2 += area_m2;
        if (gain_m2 < 0.3 * views[b].gain_m2) { used[b] = 1; continue; }
        const double d = lengthBetween(scene.viewpoints[views[here].viewpoint], scene.viewpoints[views[b].viewpoint]);
        const double worth = (gain_m2 + kG0) * std::exp(-lambda * d);
        if (worth > best_worth) best_worth = worth, best_length = d, next = b;
      }
      if (next == here) break;
      length_m += best_length;
      score += best_worth * std::exp(-lambda * (length_m - best_length));
      here = next;
    }
    for (const auto cell : marked) shown[cell] = 0;
    if (score <= best.score) continue;
    char reason[140];
    std::snprintf(reason, sizeof reason,
                  "best of %zu views: %.2f m2 of unknown, %.2f m away, worth %.3f and %.3f by the views after it",
                  scene.viewpoints.size(), views[a].gain_m2, scene.viewpoints[views[a].viewpoint].length_m, first_worth, score - first_worth);
    best = {views[a].viewpoint, score, reason, views[a].look_rad};
  }
  if (best.score < 0) return std::nullopt;
  return best;
}

}  // namespace slam::navigate
