#include "libslam/metrics/placed_scans.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/metrics/statistics.h"
#include "libslam/metrics/view_thinning.h"
#include "libslam/rays/ray_walk.h"

namespace slam::metrics {
namespace {

using core::kNaN;
constexpr double kRounding = 1e-9;  // "within the reach" must not depend on the last digit of a coordinate

/// Points sorted into square bins as wide as the neighbourhood, so that neighbours lie in 3 x 3 bins.
class Bins {
 public:
  explicit Bins(const std::vector<core::Point2>& points) {
    entries_.reserve(points.size());
    for (const auto& p : points) {
      const double column = std::floor(p.x / kNeighbourhood_m), row = std::floor(p.y / kNeighbourhood_m);
      // Beyond that a diverged pose has put it, where a bin's number would overflow.
      constexpr double kFarthest = 1e9;
      if (std::abs(column) < kFarthest && std::abs(row) < kFarthest)
        entries_.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(column), p});
    }
    // Stable: equal bins keep the points' order, and with it every sum its bits.
    std::stable_sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      return std::tie(a.row, a.column) < std::tie(b.row, b.column);
    });
  }

  size_t size() const { return entries_.size(); }
  const core::Point2& point(size_t i) const { return entries_[i].point; }

  template <class Visit>
  void visitNeighbours(size_t i, Visit visit) const {
    const Entry& centre = entries_[i];
    for (std::int32_t row = centre.row - 1; row <= centre.row + 1; ++row) {
      auto entry =
          std::lower_bound(entries_.begin(), entries_.end(), std::pair(row, centre.column - 1),
                           [](const Entry& e, const auto& bin) { return std::pair(e.row, e.column) < bin; });
      for (; entry != entries_.end() && entry->row == row && entry->column <= centre.column + 1; ++entry) {
        const double dx = entry->point.x - centre.point.x, dy = entry->point.y - centre.point.y;
        if (dx * dx + dy * dy <= kNeighbourhood_m * kNeighbourhood_m + kRounding) visit(dx, dy);
      }
    }
  }

 private:
  struct Entry {
    std::int32_t row, column;
    core::Point2 point;
  };
  std::vector<Entry> entries_;
};

struct Spread {
  size_t neighbours = 0;  ///< without the point itself
  double entropy = kNaN, thickness_m = kNaN;
};

Spread spreadAround(const Bins& bins, size_t i) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  // Coordinates from the point itself: far from the origin the sums of squares would cancel.
  bins.visitNeighbours(i, [&](double dx, double dy) {
    n += 1;
    x += dx, y += dy;
    xx += dx * dx, xy += dx * dy, yy += dy * dy;
  });
  constexpr double kAdded = kSmallestSpread_m * kSmallestSpread_m;
  const double var_x = std::max(0.0, xx / n - x / n * (x / n)),
               var_y = std::max(0.0, yy / n - y / n * (y / n));
  const double cov = xy / n - x / n * (y / n);
  const double half_trace = (var_x + var_y) / 2;
  const double smaller = half_trace - core::hypot((var_x - var_y) / 2, cov);
  const double larger = half_trace + core::hypot((var_x - var_y) / 2, cov);
  Spread spread;
  spread.neighbours = static_cast<size_t>(n) - 1;
  spread.thickness_m = std::sqrt(std::max(0.0, smaller));
  constexpr double kTwoPi = 2 * core::kPi;
  // ln det(2 pi e S) / 2 with det(2 pi e S) = (2 pi e)^2 det S.
  spread.entropy =
      core::log(kTwoPi) + 1 + 0.5 * (core::log(std::max(0.0, smaller) + kAdded) + core::log(larger + kAdded));
  return spread;
}

}  // namespace

PointSharpness pointSharpness(const std::vector<core::Point2>& points, std::size_t most) {
  if (most == 0) throw core::ContractError("pointSharpness: expected a number of points above 0");
  const Bins bins(points);
  const size_t step = std::max<size_t>(1, (bins.size() + most - 1) / most);
  PointSharpness sharpness{kNaN, kNaN, 0, 0};
  std::vector<double> thicknesses_m;
  double sum = 0;
  for (size_t i = 0; i < bins.size(); i += step) {
    const Spread spread = spreadAround(bins, i);
    ++sharpness.points;
    if (spread.neighbours < kFewestNeighbours) {
      ++sharpness.left_out;
      continue;
    }
    sum += spread.entropy;
    thicknesses_m.push_back(spread.thickness_m);
  }
  if (thicknesses_m.empty()) return sharpness;
  sharpness.mean_map_entropy = sum / static_cast<double>(thicknesses_m.size());
  sharpness.wall_thickness_m = quantile(std::move(thicknesses_m), 0.5);
  return sharpness;
}

void PlacedScans::add(const core::Pose2& T_map_lidar, const std::vector<core::Point2>& returns_lidar) {
  if (!core::isFinite(T_map_lidar)) return;
  if (views_ > 0 && !isNewView(last_view_, T_map_lidar)) return;
  last_view_ = T_map_lidar;
  Used scan{views_++, 0};
  if (!isKept(scan.view)) return;
  const core::Point2 origin_cells = world::pointToCells(map_, core::position(T_map_lidar));
  const core::RigidMotion2 T_map_returns(T_map_lidar);
  for (const auto& p_lidar : returns_lidar) {
    const core::Point2 p_map = T_map_returns * p_lidar;
    if (!std::isfinite(p_map.x) || !std::isfinite(p_map.y)) continue;
    points_.push_back(p_map);
    const core::Point2 end_cells = world::pointToCells(map_, p_map);
    if (!(end_cells.x >= 0 && end_cells.y >= 0 && end_cells.x < map_.columns && end_cells.y < map_.rows))
      continue;
    ++scan.returns;
    scan.on_wall += endsOnWall(end_cells);
    scan.through_wall += goesThroughWall(origin_cells, end_cells);
  }
  scan.points = points_.size();
  used_.push_back(scan);
  while (points_.size() > most_points_ && used_.size() > 1) dropHalf();
}

/// Multiples of the golden ratio, by their fractions: evenly spread, and no period with that of the lidars.
bool PlacedScans::isKept(std::uint64_t view) const {
  return halvings_ == 0 || view * 0x9E3779B97F4A7C15U >> (64 - halvings_) == 0;
}

void PlacedScans::dropHalf() {
  ++halvings_;
  std::size_t points = 0, scans = 0;
  for (std::size_t i = 0; i < used_.size(); ++i) {
    if (!isKept(used_[i].view)) continue;
    const auto first = points_.begin() + static_cast<std::ptrdiff_t>(i > 0 ? used_[i - 1].points : 0);
    const auto last = points_.begin() + static_cast<std::ptrdiff_t>(used_[i].points);
    points = static_cast<std::size_t>(
        std::copy(first, last, points_.begin() + static_cast<std::ptrdiff_t>(points)) - points_.begin());
    used_[scans] = used_[i];
    used_[scans++].points = points;
  }
  points_.resize(points);
  used_.resize(scans);
}

bool PlacedScans::endsOnWall(const core::Point2& end_cells) const {
  const double reach = kWallReach_m / map_.resolution_m + kRounding;
  const int first_row = std::max(0, static_cast<int>(std::floor(end_cells.y - reach)));
  const int last_row = std::min(map_.rows - 1, static_cast<int>(std::floor(end_cells.y + reach)));
  const int first_column = std::max(0, static_cast<int>(std::floor(end_cells.x - reach)));
  const int last_column = std::min(map_.columns - 1, static_cast<int>(std::floor(end_cells.x + reach)));
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first_column; column <= last_column; ++column)
      if (map_.at(column, row) == world::Cell::kOccupied &&
          core::hypot(column + 0.5 - end_cells.x, row + 0.5 - end_cells.y) <= reach)
        return true;
  return false;
}

bool PlacedScans::goesThroughWall(const core::Point2& origin_cells, const core::Point2& end_cells) const {
  const double length = core::distance(origin_cells, end_cells);
  if (!(length > 0)) return false;
  const core::Point2 direction{(end_cells.x - origin_cells.x) / length,
                               (end_cells.y - origin_cells.y) / length};
  const double enough = kWallReach_m / map_.resolution_m - kRounding;
  bool met_wall = false, is_free = false, through = false;
  double free_length = 0, entered_at = 0;
  // The length inside a cell is known when the next one is entered.
  const auto leave = [&](double at) {
    if (met_wall && is_free) free_length += std::min(at, length) - entered_at;
    return free_length >= enough;
  };
  rays::walkRay(map_, origin_cells, direction, length,
                [&](const world::Cell* cell, const rays::RayEntry& entry) {
                  const double at = entry.distance();
                  through = leave(at);
                  if (through || at >= length) {
                    is_free = false;
                    return false;
                  }
                  entered_at = at;
                  is_free = *cell == world::Cell::kFree;
                  met_wall = met_wall || *cell == world::Cell::kOccupied;
                  return true;
                });
  return through || leave(length);
}

ScanAgreement PlacedScans::agreement() const {
  std::size_t returns = 0, on_wall = 0, through_wall = 0;
  for (const Used& scan : used_)
    returns += scan.returns, on_wall += scan.on_wall, through_wall += scan.through_wall;
  const double n = static_cast<double>(returns);
  if (returns == 0) return {kNaN, kNaN, 0};
  return {static_cast<double>(on_wall) / n, static_cast<double>(through_wall) / n, returns};
}

}  // namespace slam::metrics
