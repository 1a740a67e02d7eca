#include "libslam/strategies/next_best_view.h"

#include <algorithm>
#include <cstdio>

#include "libslam/core/elementary.h"

namespace slam::strategies {
namespace {

constexpr int kDirections = 120;
constexpr std::size_t kMostViews = 12;  // that are looked further from
constexpr double kShownAlready = 0.3;   // of its gain: a view with less left is not worth a second look

struct View {
  const choices::Viewpoint* viewpoint;
  double look_rad, gain_m2, worth;
  std::vector<std::pair<std::size_t, float>> cells;
};

/// Metres from one viewpoint to another along the ways from the robot to both: back to where they part. An
/// upper bound that does not cut through walls, as a straight line would.
double lengthBetween(const choices::Viewpoint& a, const choices::Viewpoint& b) {
  const std::size_t most = std::min(a.way.size(), b.way.size());
  std::size_t common = 0;
  while (common < most && a.way[common] == b.way[common]) ++common;
  const auto rest = [&](const choices::Viewpoint& v) {
    const auto steps = static_cast<double>(std::max<std::size_t>(v.way.size(), 2) - 1);
    return v.length_m * static_cast<double>(v.way.size() - common) / steps;
  };
  return rest(a) + rest(b);
}

/// What the views after `first` are worth, each time the best one from where the last ended.
double worthAfter(const std::vector<View>& views, std::size_t first, const StrategyOptions& options,
                  std::vector<char>& shown) {
  std::vector<std::size_t> marked;
  std::vector<char> used(views.size(), 0);
  double worth = 0, length_m = views[first].viewpoint->length_m;
  std::size_t here = first;
  for (int ahead = 1; ahead < options.horizon; ++ahead) {
    used[here] = 1;
    for (const auto& cell : views[here].cells)
      if (!shown[cell.first]) shown[cell.first] = 1, marked.push_back(cell.first);
    double most = 0, leg_m = 0;
    std::size_t next = here;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (used[i]) continue;
      double gain_m2 = 0;
      for (const auto& [cell, area_m2] : views[i].cells)
        if (!shown[cell]) gain_m2 += static_cast<double>(area_m2);
      if (gain_m2 < kShownAlready * views[i].gain_m2) continue;
      const double to_m = lengthBetween(*views[here].viewpoint, *views[i].viewpoint);
      const double then = (gain_m2 + options.view_bonus_m2) * core::exp(-options.lambda_per_m * to_m);
      if (then <= most) continue;
      most = then, leg_m = to_m, next = i;
    }
    if (next == here) break;
    worth += most * core::exp(-options.lambda_per_m * length_m);
    length_m += leg_m;
    here = next;
  }
  for (const std::size_t cell : marked) shown[cell] = 0;
  return worth;
}

}  // namespace

std::optional<MapStrategy::Choice> NextBestView::choose(const Prospects& prospects) {
  std::vector<View> views;
  for (const auto& viewpoint : prospects.viewpoints) {
    const auto profile = paths::expectedGain(prospects.space, viewpoint.p_map, prospects.view,
                                             options().unknown_path_m, kDirections);
    const double look_rad = profile.bestHeading(prospects.view);
    const double gain_m2 = profile.within(prospects.view, look_rad);
    if (gain_m2 < options().gain_min_m2) continue;
    const double worth =
        (gain_m2 + options().view_bonus_m2) * core::exp(-options().lambda_per_m * viewpoint.length_m);
    views.push_back({&viewpoint, look_rad, gain_m2, worth, {}});
  }
  if (views.empty()) return std::nullopt;
  std::stable_sort(views.begin(), views.end(),
                   [](const View& a, const View& b) { return a.worth > b.worth; });
  views.resize(std::min(views.size(), kMostViews));
  for (auto& view : views)
    view.cells = paths::expectedCells(prospects.space, view.viewpoint->p_map, prospects.view, view.look_rad,
                                      options().unknown_path_m, kDirections);

  if (shown_.size() != prospects.space.state.size()) shown_.assign(prospects.space.state.size(), 0);
  const View* best = nullptr;
  double most = 0, most_then = 0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double then = worthAfter(views, i, options(), shown_);
    if (best && views[i].worth + then <= most) continue;
    best = &views[i];
    most = views[i].worth + then;
    most_then = then;
  }
  char reason[160];
  std::snprintf(reason, sizeof reason,
                "best of %zu views: %.2f m2 of unknown, %.2f m away, worth %.3f and %.3f by what comes after",
                prospects.viewpoints.size(), best->gain_m2, best->viewpoint->length_m, best->worth,
                most_then);
  return Choice{static_cast<std::size_t>(best->viewpoint - prospects.viewpoints.data()), most, reason,
                best->look_rad};
}

}  // namespace slam::strategies
