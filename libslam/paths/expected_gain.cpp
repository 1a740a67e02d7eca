#include "libslam/paths/expected_gain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libslam/core/elementary.h"

namespace slam::paths {
namespace {

/// Less than this share of a cell's area is not worth walking on for.
constexpr double kFaint = 0.01;

/// Walks along a ray (Amanatides and Woo, Eurographics 1987) and calls visit(cell, area_m2) for every unknown
/// cell; the area is that of the ray's wedge inside the cell, damped by the unknown before it.
template <class Visit>
void sweep(const FreeSpace& space, const core::Point2& p_map, double angle_rad, double wedge_rad,
           double max_range_m, double unknown_path_m, Visit visit) {
  const double cell_m = space.resolution_m;
  const double x = (p_map.x - space.x_min_m) / cell_m, y = (p_map.y - space.y_min_m) / cell_m;
  int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const auto [s, c] = core::sinCos(angle_rad);
  const double infinity = std::numeric_limits<double>::infinity();
  const int dc = c < 0 ? -1 : 1, dr = s < 0 ? -1 : 1;
  const double per_column = c != 0 ? 1 / std::abs(c) : infinity,
               per_row = s != 0 ? 1 / std::abs(s) : infinity;
  double next_column = c != 0 ? (c < 0 ? x - column : column + 1 - x) * per_column : infinity;
  double next_row = s != 0 ? (s < 0 ? y - row : row + 1 - y) * per_row : infinity;
  const double end = max_range_m / cell_m, damping = cell_m / unknown_path_m;
  double at = 0, unknown = 0;
  while (space.contains(column, row) && at < end) {
    const std::uint8_t state = space.state[space.index(column, row)];
    if (state == kOccupiedCell) return;
    const double leave = std::min({next_column, next_row, end});
    if (state == kUnknownCell) {
      const double inside = leave - at;
      const double seen = core::exp(-(unknown + 0.5 * inside) * damping);
      if (seen < kFaint) return;
      visit(space.index(column, row), seen * wedge_rad * 0.5 * (at + leave) * inside * cell_m * cell_m);
      unknown += inside;
    }
    at = leave;
    if (next_column <= next_row) {
      column += dc;
      next_column += per_column;
    } else {
      row += dr;
      next_row += per_row;
    }
  }
}

double directionOf(int i, int directions) {
  return (i + 0.5) * 2 * core::kPi / directions;
}

bool covers(const LookShape& view, double heading_rad, double direction_rad) {
  if (view.full_circle) return true;
  double from_first = core::wrapToPi(direction_rad - heading_rad - view.first_rad);
  if (from_first < 0) from_first += 2 * core::kPi;
  return from_first <= view.fov_rad;
}

}  // namespace

LookShape lookShape(const lidar::Scan& scan) {
  LookShape view;
  view.full_circle = scan.isFullCircle();
  const double beams = static_cast<double>(scan.ranges_m.size());
  view.fov_rad = view.full_circle ? 2 * core::kPi : std::max(0.0, beams - 1) * scan.step_rad;
  view.first_rad = core::wrapToPi(scan.first_angle_rad + scan.T_robot_lidar.phi);
  view.max_range_m = scan.max_range_m;
  return view;
}

double GainProfile::total() const {
  return std::accumulate(area_m2.begin(), area_m2.end(), 0.0);
}

double GainProfile::within(const LookShape& view, double heading_rad) const {
  double sum_m2 = 0;
  const int directions = static_cast<int>(area_m2.size());
  for (int i = 0; i < directions; ++i)
    if (covers(view, heading_rad, directionOf(i, directions))) sum_m2 += area_m2[static_cast<std::size_t>(i)];
  return sum_m2;
}

double GainProfile::bestHeading(const LookShape& view) const {
  const int directions = static_cast<int>(area_m2.size());
  if (directions == 0) return 0;
  // Heading along direction 0 the view covers one circular run of directions; other headings shift the run.
  const double heading_rad = directionOf(0, directions);
  int first = -1, count = 0;
  for (int i = 0; i < directions; ++i) {
    if (!covers(view, heading_rad, directionOf(i, directions))) continue;
    ++count;
    if (!covers(view, heading_rad, directionOf(i - 1, directions))) first = i;
  }
  if (first < 0) return core::wrapToPi(heading_rad);  // everything, or nothing
  std::vector<double> sum_m2(2 * area_m2.size() + 1, 0.0);
  for (std::size_t i = 0; i + 1 < sum_m2.size(); ++i) sum_m2[i + 1] = sum_m2[i] + area_m2[i % area_m2.size()];
  int best = 0;
  double most_m2 = -1;
  for (int i = 0; i < directions; ++i) {
    const auto begin = static_cast<std::size_t>((first + i) % directions);
    const double seen_m2 = sum_m2[begin + static_cast<std::size_t>(count)] - sum_m2[begin];
    if (seen_m2 <= most_m2 + 1e-9) continue;
    most_m2 = seen_m2;
    best = i;
  }
  return core::wrapToPi(directionOf(best, directions));
}

GainProfile expectedGain(const FreeSpace& space, const core::Point2& p_map, const LookShape& view,
                         double unknown_path_m, int directions) {
  GainProfile profile;
  profile.area_m2.assign(static_cast<std::size_t>(directions), 0.0);
  const double wedge_rad = 2 * core::kPi / directions;
  for (int i = 0; i < directions; ++i)
    sweep(space, p_map, directionOf(i, directions), wedge_rad, view.max_range_m, unknown_path_m,
          [&](std::size_t, double area_m2) { profile.area_m2[static_cast<std::size_t>(i)] += area_m2; });
  return profile;
}

std::vector<std::pair<std::size_t, float>> expectedCells(const FreeSpace& space, const core::Point2& p_map,
                                                         const LookShape& view, double heading_rad,
                                                         double unknown_path_m, int directions) {
  std::vector<std::pair<std::size_t, float>> cells;
  const double wedge_rad = 2 * core::kPi / directions;
  for (int i = 0; i < directions; ++i)
    if (covers(view, heading_rad, directionOf(i, directions)))
      sweep(space, p_map, directionOf(i, directions), wedge_rad, view.max_range_m, unknown_path_m,
            [&](std::size_t cell, double area_m2) { cells.emplace_back(cell, static_cast<float>(area_m2)); });
  return cells;
}

}  // namespace slam::paths
