#include "libslam/navigate/next_best_view.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace slam::navigate {
namespace {

constexpr int kDirections = 120;
constexpr std::size_t kMostFirst = 12;  // views that are looked further from

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

MapStrategy::Choice NextBestView::choose(const Scene& scene) {
  const double lambda = options().lambda_per_m;
  std::vector<View> views;
  for (std::size_t i = 0; i < scene.viewpoints.size(); ++i) {
    const Viewpoint& viewpoint = scene.viewpoints[i];
    const auto profile =
        expectedGain(scene.space, viewpoint.p_map, scene.view, options().unknown_path_m, kDirections);
    const double look_rad = profile.bestHeading(scene.view);
    const double gain_m2 = profile.within(scene.view, look_rad);
    views.push_back({i, look_rad, gain_m2, gain_m2 * std::exp(-lambda * viewpoint.length_m)});
  }
  std::stable_sort(views.begin(), views.end(),
                   [](const View& a, const View& b) { return a.worth > b.worth; });
  views.resize(std::min(views.size(), kMostFirst));

  std::vector<std::vector<std::pair<std::size_t, float>>> cells;
  for (const auto& view : views)
    cells.push_back(expectedCells(scene.space, scene.viewpoints[view.viewpoint].p_map, scene.view,
                                  view.look_rad, options().unknown_path_m, kDirections));
  std::vector<char> shown(options().horizon > 1 ? scene.space.state.size() : 0, 0);
  Choice best;
  best.score = -1;
  for (std::size_t a = 0; a < views.size(); ++a) {
    const Viewpoint& first = scene.viewpoints[views[a].viewpoint];
    double then = 0;
    if (options().horizon > 1) {
      for (const auto& cell : cells[a]) shown[cell.first] = 1;
      for (std::size_t b = 0; b < views.size(); ++b) {
        if (a == b) continue;
        const Viewpoint& second = scene.viewpoints[views[b].viewpoint];
        double gain_m2 = 0;
        for (const auto& [cell, area_m2] : cells[b])
          if (!shown[cell]) gain_m2 += area_m2;
        then = std::max(then, gain_m2 * std::exp(-lambda * (first.length_m + lengthBetween(first, second))));
      }
      for (const auto& cell : cells[a]) shown[cell.first] = 0;
    }
    const double score = views[a].worth + then;
    if (score <= best.score) continue;
    char reason[140];
    std::snprintf(
        reason, sizeof reason,
        "best of %zu views: %.2f m2 of unknown, %.2f m away, worth %.3f and %.3f by the view after it",
        scene.viewpoints.size(), views[a].gain_m2, first.length_m, views[a].worth, then);
    best = {views[a].viewpoint, score, reason, views[a].look_rad};
  }
  return best;
}

}  // namespace slam::navigate
