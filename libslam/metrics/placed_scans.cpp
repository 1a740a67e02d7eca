#include "libslam/metrics/placed_scans.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <utility>

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

/// Points in square bins as wide as the neighbourhood, so that neighbours lie in 3 x 3 bins; sorted where
/// they lie, and not copied: they are many.
class Bins {
 public:
  explicit Bins(std::vector<core::Point2> points) : points_(std::move(points)) {
    points_.erase(std::remove_if(points_.begin(), points_.end(), [](const auto& p) { return !hasBin(p); }),
                  points_.end());
    // By coordinates, too: every sum has the same bits, whatever the order was.
    std::sort(points_.begin(), points_.end(), [](const core::Point2& a, const core::Point2& b) {
      const Bin of_a(a), of_b(b);
      return of_a == of_b ? std::tie(a.y, a.x) < std::tie(b.y, b.x) : of_a < of_b;
    });
  }

  size_t size() const { return points_.size(); }

  template <class Visit>
  void visitNeighbours(size_t i, Visit visit) const {
    const core::Point2& centre = points_[i];
    const Bin middle(centre);
    for (auto row = middle.row - 1; row <= middle.row + 1; ++row) {
      auto p = std::lower_bound(points_.begin(), points_.end(), Bin(row, middle.column - 1),
                                [](const core::Point2& a, const Bin& bin) { return Bin(a) < bin; });
      const Bin last(row, middle.column + 1);
      for (; p != points_.end() && !(last < Bin(*p)); ++p) {
        const double dx = p->x - centre.x, dy = p->y - centre.y;
        if (dx * dx + dy * dy <= kNeighbourhood_m * kNeighbourhood_m + kRounding) visit(dx, dy);
      }
    }
  }

 private:
  struct Bin {
    explicit Bin(const core::Point2& p) : row(numberOf(p.y)), column(numberOf(p.x)) {}
    Bin(std::int64_t row_, std::int64_t column_) : row(row_), column(column_) {}
    bool operator<(const Bin& b) const { return row != b.row ? row < b.row : column < b.column; }
    bool operator==(const Bin& b) const { return row == b.row && column == b.column; }
    std::int64_t row, column;
  };
  static std::int64_t numberOf(double x_m) {
    const double bins = x_m / kNeighbourhood_m;
    const auto whole = static_cast<std::int64_t>(bins);
    return whole - (static_cast<double>(whole) > bins ? 1 : 0);
  }
  static bool hasBin(const core::Point2& p) {
    // Beyond that a diverged pose has put it, where a bin's number would overflow.
    constexpr double kFarthest_m = 1e9 * kNeighbourhood_m;
    return std::abs(p.x) < kFarthest_m && std::abs(p.y) < kFarthest_m;
  }

  std::vector<core::Point2> points_;
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

PointSharpness pointSharpness(std::vector<core::Point2> points, std::size_t most) {
  if (most == 0) throw core::ContractError("pointSharpness: expected a number of points above 0");
  const Bins bins(std::move(points));
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
