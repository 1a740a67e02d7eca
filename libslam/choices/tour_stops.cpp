#include "libslam/choices/tour_stops.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::choices {
namespace {

constexpr double kDepthPerWidth = 0.5;
constexpr int kDirections = 120;
constexpr double kFaint = 0.05;  // less than this share of a cell's area is not worth walking on for

/// The cells along a ray in turn (Amanatides and Woo, Eurographics 1987), with where the ray enters and
/// leaves them, in cells; until visit() answers false.
template <class Visit>
void walk(const paths::FreeSpace& space, const core::Point2& p_map, double angle_rad, double end,
          Visit visit) {
  const double x = (p_map.x - space.x_min_m) / space.resolution_m;
  const double y = (p_map.y - space.y_min_m) / space.resolution_m;
  int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
  const auto [s, c] = core::sinCos(angle_rad);
  const double infinity = std::numeric_limits<double>::infinity();
  const double per_column = c != 0 ? 1 / std::abs(c) : infinity;
  const double per_row = s != 0 ? 1 / std::abs(s) : infinity;
  double next_column = c != 0 ? (c < 0 ? x - column : column + 1 - x) * per_column : infinity;
  double next_row = s != 0 ? (s < 0 ? y - row : row + 1 - y) * per_row : infinity;
  for (double at = 0; space.contains(column, row) && at < end;) {
    const double leave = std::min({next_column, next_row, end});
    if (!visit(space.index(column, row), at, leave)) return;
    at = leave;
    if (next_column <= next_row) {
      column += c < 0 ? -1 : 1;
      next_column += per_column;
    } else {
      row += s < 0 ? -1 : 1;
      next_row += per_row;
    }
  }
}

}  // namespace

Openings::Openings(const paths::FreeSpace& space, const std::vector<paths::Frontier>& frontiers,
                   double door_m, double deepest_m)
    : deepest_m_(deepest_m) {
  for (const auto& frontier : frontiers) {
    core::Point2 low = space.centreOf(frontier.cells.front()), high = low;
    for (const std::size_t cell : frontier.cells) {
      const core::Point2 p = space.centreOf(cell);
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const double width_m = core::distance(low, high) + space.resolution_m;
    const double depth_m = width_m < door_m ? std::min(kDepthPerWidth * width_m, deepest_m) : deepest_m;
    for (const std::size_t cell : frontier.cells) depth_m_.emplace_back(cell, static_cast<float>(depth_m));
  }
  std::sort(depth_m_.begin(), depth_m_.end());
}

void Openings::shut(std::size_t cell) {
  const auto found = std::lower_bound(depth_m_.begin(), depth_m_.end(), std::pair(cell, -1.0F));
  if (found == depth_m_.end() || found->first != cell)
    throw core::ContractError("Openings::shut: expected a cell of a frontier");
  found->second = 0;
}

double Openings::depth_m(std::size_t cell) const {
  const auto found = std::lower_bound(depth_m_.begin(), depth_m_.end(), std::pair(cell, -1.0F));
  return found != depth_m_.end() && found->first == cell ? static_cast<double>(found->second) : deepest_m_;
}

Look lookAround(const paths::FreeSpace& space, const Openings& openings, const core::Point2& p_map,
                double max_range_m) {
  Look look;
  look.profile.area_m2.assign(kDirections, 0.0);
  const double wedge_rad = 2 * core::kPi / kDirections, cell_m = space.resolution_m;
  for (int i = 0; i < kDirections; ++i) {
    double passed = 0, depth_m = openings.deepest_m();
    bool was_unknown = true;  // who stands in the unknown has come by no opening
    std::size_t before = 0;
    const auto visit = [&](std::size_t cell, double from, double to) {
      const std::uint8_t state = space.state[cell];
      if (state == paths::kOccupiedCell) return false;
      const bool unknown = state == paths::kUnknownCell;
      if (unknown) {
        if (!was_unknown) depth_m = openings.depth_m(before);
        if (depth_m <= 0) return false;
        const double step = (to - from) * cell_m / depth_m;
        const double seen = core::exp(-(passed + 0.5 * step));
        if (seen < kFaint) return false;
        const double area_m2 = seen * wedge_rad * 0.5 * (from + to) * (to - from) * cell_m * cell_m;
        look.cells.emplace_back(cell, static_cast<float>(area_m2));
        look.profile.area_m2[static_cast<std::size_t>(i)] += area_m2;
        passed += step;
      }
      was_unknown = unknown;
      before = cell;
      return true;
    };
    walk(space, p_map, (i + 0.5) * wedge_rad, max_range_m / cell_m, visit);
  }
  look.area_m2 = look.profile.total();
  return look;
}

std::vector<Look> coveringLooks(std::vector<Look> looks, std::size_t cells, double least_m2,
                                std::size_t most) {
  std::vector<char> shown(cells, 0);
  std::vector<Look> cover;
  const auto shows_less = [](const Look& a, const Look& b) {
    return a.area_m2 != b.area_m2 ? a.area_m2 < b.area_m2 : a.place > b.place;
  };
  // What a look adds only falls: it is counted anew only when it is the next (Minoux, 1978).
  std::make_heap(looks.begin(), looks.end(), shows_less);
  while (!looks.empty() && cover.size() < most) {
    std::pop_heap(looks.begin(), looks.end(), shows_less);
    Look& next = looks.back();
    next.area_m2 = 0;
    for (const auto& [cell, area_m2] : next.cells)
      if (!shown[cell]) next.area_m2 += static_cast<double>(area_m2);
    if (next.area_m2 < least_m2) {
      looks.pop_back();
    } else if (looks.size() > 1 && shows_less(next, looks.front())) {
      std::push_heap(looks.begin(), looks.end(), shows_less);
    } else {
      for (const auto& cell : next.cells) shown[cell.first] = 1;
      cover.push_back(std::move(next));
      looks.pop_back();
    }
  }
  return cover;
}

}  // namespace slam::choices
