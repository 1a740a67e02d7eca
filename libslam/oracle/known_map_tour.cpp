#include "libslam/oracle/known_map_tour.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"
#include "libslam/oracle/bound_below.h"
#include "libslam/oracle/cover_search.h"
#include "libslam/oracle/drive_graph.h"
#include "libslam/oracle/views.h"

namespace slam::oracle {
namespace {

using core::kNaN;
constexpr std::size_t kMostNodes = 40000;
// The search counts samples, the drive cells and what is seen between the views: it is asked for a little
// more and for a little less than the share, and the shortest drive that reaches it counts.
constexpr double kMore[] = {0.0, 0.003, -0.003, 0.006, -0.006, 0.009};
constexpr double kMuchMore[] = {0.02, 0.04, 0.08};  // where none of these got there

/// Drives the path and looks round, until the share is explored.
KnownMapTour drive(const world::Plan& plan, const metrics::ExplorableArea& area, const TourRequest& request,
                   const std::vector<core::Point2>& path, double share) {
  KnownMapTour tour;
  tour.share = share;
  tour.length_m = kNaN;
  metrics::Coverage coverage(plan, area);
  const int beams = std::max(1, static_cast<int>(std::lround(2 * core::kPi / request.beam_step_rad)));
  double path_m = 0;
  const auto look = [&](const core::Point2& p, double heading_rad) {
    coverage.look({p.x, p.y, heading_rad}, -core::kPi, 2 * core::kPi / beams, beams, request.max_range_m);
    tour.curve.push_back({path_m, coverage.share()});
    if (!(coverage.share() >= share)) return false;
    tour.length_m = path_m;
    return true;
  };
  tour.path.push_back(path.front());
  if (look(path.front(), 0)) return tour;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const core::Point2 from = path[i - 1], to = path[i];
    const double length_m = core::distance(from, to);
    const double heading_rad = core::atan2(to.y - from.y, to.x - from.x);
    const int steps = std::max(1, static_cast<int>(std::ceil(length_m / kCurveStep_m)));
    for (int k = 1; k <= steps; ++k) {
      const double s = static_cast<double>(k) / steps;
      const core::Point2 here{from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)};
      path_m += length_m / steps;
      if (!look(here, heading_rad) && k < steps) continue;
      tour.path.push_back(here);
      if (std::isfinite(tour.length_m)) return tour;
    }
  }
  return tour;
}

bool isBetter(const KnownMapTour& a, const KnownMapTour& b) {
  if (std::isnan(a.length_m) != std::isnan(b.length_m)) return std::isnan(b.length_m);
  return std::isnan(a.length_m) ? a.curve.back().share > b.curve.back().share : a.length_m < b.length_m;
}

}  // namespace

Oracle consultOracle(const world::Plan& plan, const metrics::ExplorableArea& area, const TourRequest& request,
                     const std::function<void()>& go_on) {
  Oracle oracle;
  oracle.to_90.share = 0.90, oracle.to_99.share = 0.99;
  for (auto* tour : {&oracle.to_90, &oracle.to_99}) tour->length_m = kNaN;
  const DriveGraph graph(plan, request.start_world, request.radius_m, DriveGraph::blockFor(plan, kMostNodes));
  if (graph.size() == 0 || area.cells == 0) return oracle;
  ViewOptions options;
  options.max_range_m = request.max_range_m;
  const Views views = sampleViews(plan, area, graph, options);
  CoverSearch search(graph, views);
  for (auto* best : {&oracle.to_90, &oracle.to_99}) {
    KnownMapTour found;
    const auto attempt = [&](double more) {
      const auto samples = static_cast<std::size_t>(
          std::ceil(std::min(1.0, best->share + more) * static_cast<double>(views.samples)));
      const auto tour = search.search(samples, request.rounds, go_on);
      auto driven = drive(plan, area, request, search.path(tour), best->share);
      if (found.curve.empty() || isBetter(driven, found)) found = std::move(driven);
    };
    for (const double more : kMore) attempt(more);
    for (const double more : kMuchMore)
      if (std::isnan(found.length_m)) attempt(more);
    *best = std::move(found);
  }
  const auto below = boundBelow(plan, area, request.start_world, request.radius_m, request.lidar_offset_m,
                                request.max_range_m, go_on);
  oracle.below_90_m = below.below_90_m;
  oracle.below_99_m = below.below_99_m;
  return oracle;
}

}  // namespace slam::oracle
