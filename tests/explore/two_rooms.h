#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/resources.h"
#include "libslam/explore/explore.h"
#include "libslam/testing/temp_folder.h"

namespace slam::explore {

/// A flat of two rooms, 6 x 4 m at 5 cm, joined by a door of 1 m; cells as drawn by the caller's lambda.
inline world::Plan twoRooms() {
  world::Plan plan;
  plan.name = "two_rooms";
  plan.columns = 120;
  plan.rows = 80;
  plan.cells.assign(120 * 80, world::Cell::kFree);
  const auto wall = [&plan](int c0, int r0, int c1, int r1) {
    for (int row = r0; row < r1; ++row)
      for (int column = c0; column < c1; ++column)
        plan.cells[static_cast<size_t>(row * plan.columns + column)] = world::Cell::kOccupied;
  };
  wall(0, 0, 120, 2), wall(0, 78, 120, 80), wall(0, 0, 2, 80), wall(118, 0, 120, 80);
  wall(60, 0, 63, 30), wall(60, 50, 63, 80);
  return plan;
}

inline std::string saved(const testing::TempFolder& folder, const world::Plan& plan) {
  const std::string path = folder / (plan.name + ".yaml");
  world::savePlan(plan, path);
  return path;
}

/// A full circle of 2 degree beams: quick.
inline ExploreConfig quickConfig(const std::string& strategy, double duration_s,
                                 const std::vector<std::string>& settings = {}) {
  core::IniFile ini;
  for (const auto& [key, value] : std::map<std::string, std::string>{
           {"lidar.beams", "180"}, {"lidar.fov_deg", "360"}, {"lidar.max_range_m", "8"}})
    ini.setFromArgument(key + "=" + value, "test");
  ini.set("strategy", "name", strategy, "test");
  ini.set("simulation", "duration_s", core::formatNumber(duration_s), "test");
  for (const auto& setting : settings) ini.setFromArgument(setting, "test");
  return readExploreConfig(ini);
}

inline ExploreRequest request(const testing::TempFolder& folder, const world::Plan& plan,
                              std::vector<ExploreConfig> configs, const std::string& slam) {
  ExploreRequest request;
  request.plan_path = saved(folder, plan);
  request.strategies = std::move(configs);
  request.slam = slam;
  request.methods_folder = core::configsFolder() + "/methods";
  request.output = folder / "out";
  return request;
}

inline ExplorationReport run(const ExploreRequest& request) {
  return explore(request, {}, core::silentProgress());
}

}  // namespace slam::explore
