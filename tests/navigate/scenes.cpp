#include "tests/navigate/scenes.h"

#include <algorithm>

#include "libslam/rays/ray_caster.h"

namespace slam::navigate::scenes {
namespace {

using world::Cell;
using world::Plan;

// Marking costs more than simulating, and a robot moves little between two scans.
constexpr int kMarkedScan = 5;

size_t index(const Plan& plan, int column, int row) {
  return static_cast<size_t>(row) * plan.columns + column;
}

/// 1 for the floor that is 4-connected with p_world.
std::vector<char> connectedFloor(const Plan& plan, const core::Point2& p_world) {
  std::vector<char> floor(plan.cells.size(), 0);
  const auto p = world::pointToCells(plan, p_world);
  std::vector<std::pair<int, int>> open = {{static_cast<int>(p.x), static_cast<int>(p.y)}};
  floor[index(plan, open[0].first, open[0].second)] = 1;
  while (!open.empty()) {
    const auto [column, row] = open.back();
    open.pop_back();
    for (const auto& [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int c = column + dc, r = row + dr;
      if (!plan.contains(c, r) || plan.at(c, r) != Cell::kFree || floor[index(plan, c, r)]) continue;
      floor[index(plan, c, r)] = 1;
      open.push_back({c, r});
    }
  }
  return floor;
}

/// Marks what the rays of a scan passed, every half cell.
void markSeen(const Plan& plan, const core::Pose2& T_world_robot, const lidar::Scan& scan,
              std::vector<char>& seen) {
  const core::Pose2 T_world_lidar = T_world_robot * scan.T_robot_lidar;
  const auto origin = world::pointToCells(plan, core::position(T_world_lidar));
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (!lidar::isReturn(scan.ranges_m[i])) continue;
    const double angle = T_world_lidar.phi + scan.angle(i) - plan.T_frame_raster.phi;
    const double c = std::cos(angle), s = std::sin(angle), end = scan.ranges_m[i] / plan.resolution_m;
    for (double r = 0; r < end; r += 0.5) {
      const int column = static_cast<int>(origin.x + r * c), row = static_cast<int>(origin.y + r * s);
      if (plan.contains(column, row)) seen[index(plan, column, row)] = 1;
    }
  }
}

double share(const std::vector<char>& seen, const std::vector<char>& floor) {
  size_t both = 0;
  for (size_t i = 0; i < floor.size(); ++i) both += seen[i] && floor[i];
  return static_cast<double>(both) / static_cast<double>(std::count(floor.begin(), floor.end(), char{1}));
}

}  // namespace

Plan room(double width_m, double height_m) {
  Plan plan;
  plan.name = "room";
  plan.columns = static_cast<int>(std::lround(width_m / plan.resolution_m)) + 4;
  plan.rows = static_cast<int>(std::lround(height_m / plan.resolution_m)) + 4;
  plan.T_frame_raster = {-2 * plan.resolution_m, -2 * plan.resolution_m, 0};
  plan.cells.assign(static_cast<size_t>(plan.columns) * plan.rows, Cell::kOccupied);
  fill(plan, 0, 0, width_m, height_m, Cell::kFree);
  return plan;
}

void fill(Plan& plan, double x0, double y0, double x1, double y1, Cell cell) {
  const auto low = world::pointToCells(plan, {x0, y0}), high = world::pointToCells(plan, {x1, y1});
  for (int row = static_cast<int>(std::lround(low.y)); row < std::lround(high.y); ++row)
    for (int column = static_cast<int>(std::lround(low.x)); column < std::lround(high.x); ++column)
      plan.cells[index(plan, column, row)] = cell;
}

lidar::Scan scanIn(const Plan& plan, const core::Pose2& T_world_robot, double time_s) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::degToRad(0.5);
  scan.max_range_m = 10;
  for (size_t i = 0; i < 720; ++i)
    scan.ranges_m.push_back(static_cast<float>(
        rays::castRay(plan, core::position(T_world_robot), T_world_robot.phi + scan.angle(i), 10)));
  return scan;
}

Plan flat() {
  Plan plan = room(12, 8);
  plan.name = "drawn flat";
  fill(plan, 0, 3.2, 12, 3.3);  // the corridor lies between y = 3.3 and 4.7
  fill(plan, 0, 4.7, 12, 4.8);
  fill(plan, 6.0, 0, 6.1, 3.2);
  fill(plan, 5.0, 4.8, 5.1, 8.0);
  for (const double x : {2.0, 9.0}) fill(plan, x, 3.2, x + 0.9, 3.3, Cell::kFree);
  for (const double x : {3.2, 7.5}) fill(plan, x, 4.7, x + 0.9, 4.8, Cell::kFree);
  fill(plan, 0.5, 0.5, 1.5, 1.2);
  fill(plan, 10.5, 1.0, 11.0, 2.0);
  fill(plan, 1.0, 7.0, 2.5, 7.6);
  fill(plan, 9.0, 6.0, 9.1, 6.1);
  return plan;
}

lidar::LidarOptions circleLidar() {
  lidar::LidarOptions lidar;
  lidar.fov_rad = 2 * core::kPi;
  lidar.beams = 360;
  lidar.max_range_m = 12;
  return lidar;
}

Exploration explore(const Plan& plan, const core::Pose2& start, const strategies::StrategyOptions& options,
                    const lidar::LidarOptions& lidar, std::uint64_t seed, double duration_s) {
  const robot::RobotOptions robot;
  const double period_s = 1 / lidar.rate_hz;
  sim::Simulator simulator(plan, robot, lidar, {}, start, seed);
  Driver driver(strategies::makeStrategy(options, {seed, "strategy"}), options, robot, period_s,
                {seed, "driver"});
  const auto floor = connectedFloor(plan, core::position(start));
  std::vector<char> seen(plan.cells.size(), 0);

  Exploration result;
  sim::Sensed sensed = simulator.sense();
  const int periods = static_cast<int>(std::lround(duration_s / period_s));
  for (int i = 0; i < periods; ++i) {
    result.truth.push_back(simulator.truth());
    if (i % kMarkedScan == 0) markSeen(plan, simulator.truth(), sensed.scan, seen);
    if (i == periods / 2) result.seen_share_half = share(seen, floor);
    const auto command = driver.next(sensed.scan, sensed.T_odom_robot, sensed.collided);
    const std::string& reason = driver.currentDecision().reason;
    if (result.decisions.empty() || result.decisions.back() != reason) result.decisions.push_back(reason);
    sensed = simulator.step(command);
  }
  result.collisions = simulator.collisions().size();
  result.seen_share = share(seen, floor);
  return result;
}

std::vector<std::string> maplessStrategies() {
  std::vector<std::string> names;
  for (const auto& name : strategies::strategyNames())
    if (!strategies::strategyNeedsMap(name)) names.push_back(name);
  return names;
}

PerfectMap::PerfectMap(const Plan& plan) : plan_(plan) {
  raster_.columns = plan.columns, raster_.rows = plan.rows;
  raster_.resolution_m = plan.resolution_m;
  raster_.x_min_m = plan.T_frame_raster.x, raster_.y_min_m = plan.T_frame_raster.y;
  raster_.occupancy.assign(plan.cells.size(), 0.5F);
}

void PerfectMap::insert(const core::Pose2& T_world_robot, const lidar::Scan& scan) {
  const core::Pose2 T_world_lidar = T_world_robot * scan.T_robot_lidar;
  const auto origin = world::pointToCells(plan_, core::position(T_world_lidar));
  const double end = scan.max_range_m / plan_.resolution_m;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double angle = T_world_lidar.phi + scan.angle(i) - plan_.T_frame_raster.phi;
    const double c = std::cos(angle), s = std::sin(angle);
    for (double r = 0; r < end; r += 0.5) {
      const int column = static_cast<int>(origin.x + r * c), row = static_cast<int>(origin.y + r * s);
      if (!plan_.contains(column, row)) break;
      const bool is_free = plan_.at(column, row) != Cell::kOccupied;
      raster_.occupancy[index(plan_, column, row)] = is_free ? 0.02F : 0.98F;
      if (!is_free) break;
    }
  }
}

double PerfectMap::seenShare(const core::Point2& p_world) const {
  std::vector<char> seen(plan_.cells.size());
  for (size_t i = 0; i < seen.size(); ++i) seen[i] = raster_.occupancy[i] < 0.5F;
  return share(seen, connectedFloor(plan_, p_world));
}

MapExploration exploreOnMap(const Plan& plan, const core::Pose2& start,
                            const strategies::StrategyOptions& options, const lidar::LidarOptions& lidar,
                            std::uint64_t seed, double limit_s) {
  const robot::RobotOptions robot;
  const double period_s = 1 / lidar.rate_hz;
  sim::Simulator simulator(plan, robot, lidar, {}, start, seed, 0.0);
  Driver driver(strategies::makeStrategy(options, {seed, "strategy"}), options, robot, period_s,
                {seed, "driver"});
  PerfectMap map(plan);
  MapExploration result;
  sim::Sensed sensed = simulator.sense();
  double checked_m = -1;
  while (true) {
    map.insert(simulator.truth(), sensed.scan);
    result.truth.push_back(simulator.truth());
    if (result.path_99_m < 0 && result.path_m > checked_m + 0.25) {
      checked_m = result.path_m;
      const double seen = map.seenShare(core::position(start));
      if (seen >= 0.9 && result.path_90_m < 0) result.path_90_m = result.path_m;
      if (seen >= 0.99) result.path_99_m = result.path_m;
    }
    if (driver.finished() || simulator.time_s() >= limit_s) break;
    if (driver.wantsMap()) driver.setMap(map.raster());
    const auto command = driver.next(sensed.scan, simulator.truth(), sensed.collided);
    const choices::Decision& decision = driver.currentDecision();
    if (result.decisions.empty() || result.decisions.back().reason != decision.reason)
      result.decisions.push_back(decision);
    sensed = simulator.step(command);
    result.path_m += core::distance(result.truth.back(), simulator.truth());
  }
  result.finished = driver.finished();
  result.end = driver.currentDecision().reason;
  result.collisions = simulator.collisions().size();
  result.time_s = simulator.time_s();
  result.seen_share = map.seenShare(core::position(start));
  return result;
}

}  // namespace slam::navigate::scenes
