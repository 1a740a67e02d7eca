#include "libslam/run/known_map.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/middle_value.h"
#include "libslam/files/parameters.h"
#include "libslam/rays/sector_caster.h"
#include "libslam/results/map_cells.h"
#include "libslam/world/clearance.h"
#include "libslam/world/plan.h"

namespace slam::run {
namespace {

constexpr int kBeams = 360;
/// Fewer say nothing of the place.
constexpr int kLeastReturns = 20;
constexpr double kClearance_m = 0.3;  ///< about what a robot needs
constexpr double kCandidates_m = 0.5;
constexpr double kLeastSpacing_m = 1.5, kMostSpacing_m = 8;
/// Apart from each other by this share of what they see: half of the returns lie nearer than the median.
constexpr double kSpacingShare = 0.3;

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

world::CellMap withUnknownShut(world::CellMap map) {
  std::replace(map.cells.begin(), map.cells.end(), world::Cell::kUnknown, world::Cell::kOccupied);
  return map;
}

/// Casts in the map, in which unknown cells hide what lies behind them.
class Looker {
 public:
  Looker(const world::CellMap& map, double max_range_m)
      : map_(map),
        max_range_m_(max_range_m),
        caster_(withUnknownShut(map)),
        beams_(-core::kPi, 2 * core::kPi / kBeams, kBeams) {}

  lidar::Scan look(const core::Pose2& T_map_robot) const {
    lidar::Scan scan;
    scan.first_angle_rad = beams_.firstAngle(), scan.step_rad = beams_.step();
    scan.max_range_m = max_range_m_;
    scan.range_sigma_m = map_.resolution_m / 2;
    caster_.castScan(T_map_robot, beams_, max_range_m_, scan.ranges_m);
    for (size_t i = 0; i < scan.ranges_m.size(); ++i)
      if (lidar::isReturn(scan.ranges_m[i]) && !isWall(T_map_robot, scan.angle(i), scan.ranges_m[i]))
        scan.ranges_m[i] = lidar::kLostReading;
    return scan;
  }

 private:
  bool isWall(const core::Pose2& T, double angle_rad, double range_m) const {
    const double beyond_m = range_m + 0.01 * map_.resolution_m, angle = T.phi + angle_rad;
    const core::Point2 cell =
        world::pointToCells(map_, {T.x + beyond_m * core::cos(angle), T.y + beyond_m * core::sin(angle)});
    const int column = static_cast<int>(std::floor(cell.x)), row = static_cast<int>(std::floor(cell.y));
    return map_.contains(column, row) && map_.at(column, row) == world::Cell::kOccupied;
  }

  const world::CellMap& map_;
  double max_range_m_;
  rays::SectorCaster caster_;
  rays::BeamTable beams_;
};

double medianReturn(const lidar::Scan& scan) {
  std::vector<float> returns_m;
  for (const float range_m : scan.ranges_m)
    if (lidar::isReturn(range_m)) returns_m.push_back(range_m);
  if (returns_m.size() < static_cast<size_t>(kLeastReturns)) return 0;
  return core::middleValue(std::move(returns_m));
}

/// Where a robot has room; where it has none anywhere, every free cell.
std::vector<char> roomFor(const world::CellMap& map) {
  std::vector<char> room = world::admissibleCells(map, kClearance_m / map.resolution_m);
  if (std::find(room.begin(), room.end(), 1) == room.end()) room = world::admissibleCells(map, 0);
  return room;
}

}  // namespace

bool isGridMap(const std::string& path) {
  return endsWith(path, ".yaml") || endsWith(path, ".yml") || endsWith(path, ".gridmap.gz") ||
         endsWith(path, ".gridmap");
}

world::CellMap loadGridMap(const std::string& path) {
  if (endsWith(path, ".yaml") || endsWith(path, ".yml")) return world::loadPlan(path);  // its cells
  world::CellMap map = results::toCellMap(mapping::readGridMap(path));
  for (const auto& [cell, name] :
       {std::pair{world::Cell::kFree, "free cells"}, {world::Cell::kOccupied, "walls"}})
    if (std::find(map.cells.begin(), map.cells.end(), cell) == map.cells.end())
      throw core::InputError(path + ": found a map without " + name + ", expected one of a place");
  return map;
}

std::vector<mapping::KeyFrame> viewsOf(const world::CellMap& map, double max_range_m,
                                       const std::string& name) {
  const Looker looker(map, max_range_m);
  const std::vector<char> room = roomFor(map);
  const int stride = std::max(1, static_cast<int>(std::lround(kCandidates_m / map.resolution_m)));
  std::vector<mapping::KeyFrame> views;
  std::vector<double> spacing_m;
  for (int row = stride / 2; row < map.rows; row += stride)
    for (int column = stride / 2; column < map.columns; column += stride) {
      if (!room[static_cast<size_t>(row) * map.columns + column]) continue;
      const core::Point2 p = world::cellsToPoint(map, {column + 0.5, row + 0.5});
      const auto isCovered = [&](double by_m) {
        for (size_t i = views.size(); i-- > 0;)
          if (core::distance(core::position(views[i].T_map_robot), p) < std::min(by_m, spacing_m[i]))
            return true;
        return false;
      };
      if (isCovered(kLeastSpacing_m)) continue;
      lidar::Scan scan = looker.look({p.x, p.y, 0});
      const double median_m = medianReturn(scan);
      const double spacing = std::clamp(kSpacingShare * median_m, kLeastSpacing_m, kMostSpacing_m);
      if (median_m == 0 || isCovered(spacing)) continue;
      scan.time_s = static_cast<double>(views.size());
      views.push_back({std::move(scan), {p.x, p.y, 0}});
      spacing_m.push_back(spacing);
    }
  if (views.empty())
    throw core::InputError(name + ": found no free place from which walls are seen within " +
                           files::formatNumber(max_range_m) + " m, expected at least 1");
  return views;
}

}  // namespace slam::run
