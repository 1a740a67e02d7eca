/// CPU time of a decision on a large map: rasterslam_decisions_bench [decisions] [strategy ...]
///
/// A generated office of 100 x 100 m (2000 x 2000 cells) of which a robot knows all that is seen from its
/// left two thirds. From there each strategy decides, drives, sees what a lidar of 20 m without noise sees on
/// the way, and decides again; what is timed is reading the map and deciding. The last column is a hash of
/// all goals: two versions that decide alike have the same one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "libslam/buildings/generator.h"
#include "libslam/strategies/strategy.h"
#include "libslam/threads/cpu_time.h"

namespace {
using namespace slam;

constexpr int kBeams = 720;
constexpr double kRange_m = 20, kKnownShare = 2.0 / 3, kGrid_m = 4, kStep_m = 1;

gridmap::OccupancyRaster unknownMap(const world::Plan& plan) {
  gridmap::OccupancyRaster map;
  map.columns = plan.columns, map.rows = plan.rows;
  map.resolution_m = plan.resolution_m;
  map.occupancy.assign(plan.cells.size(), 0.5F);
  return map;
}

/// A full circle from p, into the map as well.
lidar::Scan look(const world::Plan& plan, const core::Point2& p, double time_s,
                 gridmap::OccupancyRaster& map) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = 2 * core::kPi / kBeams;
  scan.max_range_m = kRange_m;
  for (int i = 0; i < kBeams; ++i) {
    const double angle = scan.angle(static_cast<std::size_t>(i)), c = std::cos(angle), s = std::sin(angle);
    float range = lidar::kNoReturn;
    for (double r = 0; r < kRange_m; r += 0.5 * plan.resolution_m) {
      const int column = static_cast<int>((p.x + r * c) / plan.resolution_m),
                row = static_cast<int>((p.y + r * s) / plan.resolution_m);
      if (!plan.contains(column, row)) break;
      const bool is_free = plan.at(column, row) != world::Cell::kOccupied;
      map.occupancy[static_cast<std::size_t>(row) * plan.columns + column] = is_free ? 0.02F : 0.98F;
      if (is_free) continue;
      range = static_cast<float>(r);
      break;
    }
    scan.ranges_m.push_back(range);
  }
  return scan;
}

struct Costs {
  std::vector<double> ms;
  std::uint64_t hash = 14695981039346656037U;
  std::string end = "goes on";
};

void add(Costs& costs, const choices::Decision& decision) {
  for (const double value : {decision.goal.x, decision.goal.y, decision.score})
    costs.hash = (costs.hash ^ static_cast<std::uint64_t>(std::llround(value * 1e6))) * 1099511628211U;
}

Costs decide(const std::string& name, const world::Plan& plan, gridmap::OccupancyRaster map,
             core::Point2 robot, int decisions) {
  strategies::StrategyOptions options;
  options.name = name;
  const auto strategy = strategies::makeStrategy(options, {1, "strategy"});
  Costs costs;
  double time_s = 0;
  auto scan = look(plan, robot, time_s, map);
  for (int i = 0; i < decisions; ++i) {
    const double before_s = threads::cpuSeconds();
    strategy->seeMap(map);
    const auto decision = strategy->decide(scan, {robot.x, robot.y, 0});
    costs.ms.push_back(1000 * (threads::cpuSeconds() - before_s));
    add(costs, decision);
    if (decision.finished) {
      costs.end = "finished";
      break;
    }
    for (const auto& to : decision.path) {
      const int steps = std::max(1, static_cast<int>(core::distance(robot, to) / kStep_m));
      const core::Point2 from = robot;
      for (int k = 1; k <= steps; ++k) {
        const double s = static_cast<double>(k) / steps;
        robot = {from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)};
        scan = look(plan, robot, time_s += 1, map);
        strategy->seeScan(scan, {robot.x, robot.y, 0});
      }
    }
    strategy->tellOutcome(decision, true);
  }
  return costs;
}

}  // namespace

int main(int argc, char** argv) {
  const int decisions = argc > 1 ? std::atoi(argv[1]) : 100;
  std::vector<std::string> names(argv + std::min(argc, 2), argv + argc);
  if (names.empty()) names = {"nearest_frontier", "information_gain", "next_best_view", "tour"};
  buildings::BuildingOptions options;
  options.width_m = options.height_m = 100;
  const auto plan = buildings::generateBuilding("office", options, 1).plan;
  auto map = unknownMap(plan);
  core::Point2 start;
  for (double y = kGrid_m; y < plan.rows * plan.resolution_m; y += kGrid_m)
    for (double x = kGrid_m; x < kKnownShare * plan.columns * plan.resolution_m; x += kGrid_m) {
      const int column = static_cast<int>(x / plan.resolution_m),
                row = static_cast<int>(y / plan.resolution_m);
      bool is_clear = true;
      for (int r = row - 8; r <= row + 8; ++r)
        for (int c = column - 8; c <= column + 8; ++c)
          is_clear = is_clear && plan.contains(c, r) && plan.at(c, r) == world::Cell::kFree;
      if (!is_clear) continue;
      look(plan, {x, y}, 0, map);
      start = {x, y};
    }
  std::printf("%d x %d cells, CPU ms per decision\n", plan.columns, plan.rows);
  std::printf("%-18s %9s %6s %6s %6s %6s  %s\n", "strategy", "decisions", "median", "p90", "p99", "most",
              "goals");
  for (const auto& name : names) {
    auto costs = decide(name, plan, map, start, decisions);
    auto& ms = costs.ms;
    std::sort(ms.begin(), ms.end());
    const auto at = [&](double share) {
      return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1))];
    };
    std::printf("%-18s %9zu %6.1f %6.1f %6.1f %6.1f  %016llx, %s\n", name.c_str(), ms.size(), at(0.5),
                at(0.9), at(0.99), ms.back(), static_cast<unsigned long long>(costs.hash), costs.end.c_str());
    std::fflush(stdout);
  }
}
