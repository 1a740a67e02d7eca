#include "libslam/metrics/coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/numbers.h"
#include "libslam/rays/ray_walk.h"

namespace slam::metrics {
namespace {

using core::kNaN;
constexpr unsigned char kSeenFree = 1, kSeenWall = 2;

bool isInside(const world::Plan& plan, const core::Point2& cell) {
  // Not Plan::contains(): a coordinate far outside would overflow the conversion. NaN is not inside either.
  return cell.x >= 0 && cell.y >= 0 && cell.x < plan.columns && cell.y < plan.rows;
}

size_t indexOf(const world::Plan& plan, int column, int row) {
  return static_cast<size_t>(row) * static_cast<size_t>(plan.columns) + static_cast<size_t>(column);
}

double rangeInCells(const world::Plan& plan, double max_range_m) {
  return max_range_m > 0 ? max_range_m / plan.resolution_m : std::numeric_limits<double>::infinity();
}

/// Grows a set of cells from its seeds over 4-connected neighbours that `admits` accepts; each cell is asked
/// once.
template <class Admits>
std::vector<unsigned char> grow(const world::Plan& plan, const std::vector<size_t>& seeds, Admits admits) {
  enum : unsigned char { kNew, kIn, kOut };
  std::vector<unsigned char> state(plan.cells.size(), kNew);
  std::vector<size_t> open;
  const auto ask = [&](size_t cell) {
    if (state[cell] != kNew) return;
    state[cell] = admits(cell) ? kIn : kOut;
    if (state[cell] == kIn) open.push_back(cell);
  };
  for (const size_t seed : seeds) ask(seed);
  const auto columns = static_cast<size_t>(plan.columns);
  while (!open.empty()) {
    const size_t cell = open.back();
    open.pop_back();
    if (cell % columns > 0) ask(cell - 1);
    if (cell % columns + 1 < columns) ask(cell + 1);
    if (cell >= columns) ask(cell - columns);
    if (cell + columns < state.size()) ask(cell + columns);
  }
  for (auto& s : state) s = s == kIn;
  return state;
}

std::vector<unsigned char> reachableCells(const world::Plan& plan, const core::Point2& start_cell,
                                          double radius_m) {
  const int column = static_cast<int>(start_cell.x), row = static_cast<int>(start_cell.y);
  std::vector<size_t> seeds;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (plan.contains(column + dx, row + dy)) seeds.push_back(indexOf(plan, column + dx, row + dy));
  auto reachable = grow(plan, seeds, [&](size_t cell) {
    const auto columns = static_cast<size_t>(plan.columns);
    const size_t its_row = cell / columns;
    const double x = static_cast<double>(cell % columns) + 0.5;
    const double y = static_cast<double>(its_row) + 0.5;
    return plan.cells[cell] != world::Cell::kOccupied &&
           !world::discCollides(plan, world::cellsToPoint(plan, {x, y}), radius_m);
  });
  reachable[indexOf(plan, column, row)] = 1;  // where it stands it can look around
  return reachable;
}

/// Calls see(index of Plan::cells) for every cell that a ray enters within its range, the wall that ends it
/// included, until it answers false.
template <class See>
void walkCells(const world::Plan& plan, const core::Point2& origin, double angle_in_plan,
               double max_range_cells, See see) {
  const core::Point2 direction = core::polar(1, angle_in_plan);
  rays::walkRay(
      plan, origin, direction, max_range_cells, [&](const world::Cell* cell, const rays::RayEntry& entry) {
        return entry.isWithin(max_range_cells) && see(static_cast<size_t>(cell - plan.cells.data())) &&
               *cell != world::Cell::kOccupied;
      });
}

bool seesReachable(const world::Plan& plan, const std::vector<unsigned char>& reachable,
                   const core::Point2& centre, double max_range_cells) {
  // In steps of about the golden angle the first few rays already look all round; most cells need no more.
  // Coprime to the number of rays, so that every one has its turn.
  constexpr int kStride = 277;
  static_assert(kSightRays == 720, "choose kStride again");
  bool found = false;
  int ray = 0;
  for (int i = 0; i < kSightRays && !found; ++i, ray = (ray + kStride) % kSightRays)
    walkCells(plan, centre, ray * (2 * core::kPi / kSightRays), max_range_cells, [&](size_t cell) {
      found = found || reachable[cell];
      return !found;
    });
  return found;
}

double redundantShare(const std::vector<CoveragePoint>& curve) {
  double redundant_m = 0;
  const CoveragePoint* begin = &curve.front();
  for (const auto& point : curve) {
    const double length_m = point.path_m - begin->path_m;
    if (length_m < kRedundancyPiece_m && &point != &curve.back()) continue;
    if (point.explored_m2 - begin->explored_m2 < kNewArea_m2pm * length_m) redundant_m += length_m;
    begin = &point;
  }
  const double path_m = curve.back().path_m - curve.front().path_m;
  return path_m > 0 ? redundant_m / path_m : kNaN;
}

}  // namespace

ExplorableArea explorableArea(const world::Plan& plan, const core::Point2& start_world, double radius_m,
                              double max_range_m) {
  ExplorableArea area;
  area.columns = plan.columns;
  area.rows = plan.rows;
  area.explorable.assign(plan.cells.size(), 0);
  const auto free = std::count(plan.cells.begin(), plan.cells.end(), world::Cell::kFree);
  area.share_of_free = free == 0 ? kNaN : 0;
  const auto start = world::pointToCells(plan, start_world);
  if (!isInside(plan, start)) return area;
  const size_t start_cell = indexOf(plan, static_cast<int>(start.x), static_cast<int>(start.y));
  if (plan.cells[start_cell] == world::Cell::kOccupied) return area;

  const auto reachable = reachableCells(plan, start, radius_m);
  // No ray leaves a region that walls enclose: the rest of the plan need not be asked.
  std::vector<size_t> seeds;
  for (size_t cell = 0; cell < reachable.size(); ++cell)
    if (reachable[cell]) seeds.push_back(cell);
  const auto within_walls =
      grow(plan, seeds, [&](size_t cell) { return plan.cells[cell] != world::Cell::kOccupied; });
  const double max_range_cells = rangeInCells(plan, max_range_m);
  for (int row = 0; row < plan.rows; ++row)
    for (int column = 0; column < plan.columns; ++column) {
      const size_t cell = indexOf(plan, column, row);
      if (plan.cells[cell] != world::Cell::kFree || !within_walls[cell]) continue;
      area.explorable[cell] =
          reachable[cell] || seesReachable(plan, reachable, {column + 0.5, row + 0.5}, max_range_cells);
      area.cells += area.explorable[cell];
    }
  area.area_m2 = static_cast<double>(area.cells) * plan.resolution_m * plan.resolution_m;
  if (free > 0) area.share_of_free = static_cast<double>(area.cells) / static_cast<double>(free);
  return area;
}

Coverage::Coverage(const world::Plan& plan, ExplorableArea area)
    : plan_(plan), area_(std::move(area)), seen_(plan.cells.size(), 0), last_look_{kNaN, kNaN, kNaN} {
  if (area_.columns != plan.columns || area_.rows != plan.rows ||
      area_.explorable.size() != plan.cells.size())
    throw core::ContractError("Coverage: the explorable area is not the plan's");
}

std::size_t Coverage::look(const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad,
                           int beams, double max_range_m) {
  const auto origin = world::pointToCells(plan_, core::position(T_world_lidar));
  if (!isInside(plan_, origin) || !std::isfinite(T_world_lidar.phi)) return 0;
  const size_t origin_cell = indexOf(plan_, static_cast<int>(origin.x), static_cast<int>(origin.y));
  if (plan_.cells[origin_cell] == world::Cell::kOccupied) return 0;
  // A robot that stands and waits sees what it saw.
  if (T_world_lidar == last_look_) return 0;
  last_look_ = T_world_lidar;
  const double max_range_cells = rangeInCells(plan_, max_range_m);
  const size_t before = explored_;
  for (int beam = 0; beam < beams; ++beam) {
    const double angle_rad = T_world_lidar.phi + first_angle_rad + beam * step_rad - plan_.T_frame_raster.phi;
    walkCells(plan_, origin, angle_rad, max_range_cells, [this](size_t cell) {
      if (seen_[cell] == 0 && plan_.cells[cell] != world::Cell::kUnknown) {
        seen_[cell] = plan_.cells[cell] == world::Cell::kOccupied ? kSeenWall : kSeenFree;
        explored_ += area_.explorable[cell];
      }
      return true;
    });
  }
  return explored_ - before;
}

double Coverage::area_m2() const {
  return static_cast<double>(explored_) * plan_.resolution_m * plan_.resolution_m;
}

double Coverage::share() const {
  return area_.cells == 0 ? kNaN : static_cast<double>(explored_) / static_cast<double>(area_.cells);
}

SeenMask Coverage::seen() const {
  SeenMask mask;
  mask.columns = plan_.columns;
  mask.rows = plan_.rows;
  mask.wall.resize(seen_.size());
  mask.free.resize(seen_.size());
  for (size_t cell = 0; cell < seen_.size(); ++cell) {
    mask.wall[cell] = seen_[cell] == kSeenWall;
    mask.free[cell] = seen_[cell] == kSeenFree;
  }
  return mask;
}

ExplorationFigures explorationFigures(const std::vector<CoveragePoint>& curve, double explorable_m2) {
  ExplorationFigures figures{kNaN, 0, 0, 0, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  if (curve.empty()) return figures;
  const auto& end = curve.back();
  figures.time_s = end.time_s;
  figures.path_m = end.path_m;
  figures.scans = end.scans;
  figures.redundant_share = redundantShare(curve);
  if (!(explorable_m2 > 0)) return figures;
  figures.coverage = end.explored_m2 / explorable_m2;
  for (auto point = curve.rbegin(); point != curve.rend(); ++point) {
    const double share = point->explored_m2 / explorable_m2;
    const auto scans = static_cast<double>(point->scans);
    if (share >= 0.90)
      figures.t90_s = point->time_s, figures.path90_m = point->path_m, figures.scans90 = scans;
    if (share >= 0.99)
      figures.t99_s = point->time_s, figures.path99_m = point->path_m, figures.scans99 = scans;
  }
  return figures;
}

}  // namespace slam::metrics
