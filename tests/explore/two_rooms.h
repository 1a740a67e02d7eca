#pragma once
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "libslam/explore/explore.h"
#include "libslam/resources/resources.h"
#include "libslam/testing/temp_folder.h"

namespace slam::explore {

/// A block of cells, up to but without the last column and row.
struct Block {
  int first_column, first_row, last_column, last_row;
};

/// A plan at 5 cm, walls of two cells around it and these within.
inline world::Plan drawnPlan(const std::string& name, int columns, int rows, std::vector<Block> walls) {
  world::Plan plan;
  plan.name = name;
  plan.columns = columns;
  plan.rows = rows;
  plan.cells.assign(static_cast<size_t>(columns) * rows, world::Cell::kFree);
  for (const Block& side : {Block{0, 0, columns, 2}, Block{0, rows - 2, columns, rows}, Block{0, 0, 2, rows},
                            Block{columns - 2, 0, columns, rows}})
    walls.push_back(side);
  for (const Block& wall : walls)
    for (int row = wall.first_row; row < wall.last_row; ++row)
      for (int column = wall.first_column; column < wall.last_column; ++column)
        plan.cells[static_cast<size_t>(row) * columns + column] = world::Cell::kOccupied;
  return plan;
}

/// A flat of two rooms, 6 x 4 m at 5 cm, joined by a door of 1 m.
inline world::Plan twoRooms() {
  return drawnPlan("two_rooms", 120, 80, {{60, 0, 63, 30}, {60, 50, 63, 80}});
}

inline std::string saved(const testing::TempFolder& folder, const world::Plan& plan) {
  std::string path = folder / (plan.name + ".yaml");
  world::savePlan(plan, path);
  return path;
}

/// A full circle of 2 degree beams: quick.
inline ExploreConfig quickConfig(const std::string& strategy, double duration_s,
                                 const std::vector<std::string>& settings = {}) {
  files::IniFile ini;
  for (const auto& [key, value] : std::map<std::string, std::string>{
           {"lidar.beams", "180"}, {"lidar.fov_deg", "360"}, {"lidar.max_range_m", "8"}})
    ini.setFromArgument(key + "=" + value, "test");
  ini.set("strategy", "name", strategy, "test");
  ini.set("simulation", "duration_s", files::formatNumber(duration_s), "test");
  for (const auto& setting : settings) ini.setFromArgument(setting, "test");
  return readExploreConfig(ini);
}

inline ExploreRequest request(const testing::TempFolder& folder, const world::Plan& plan,
                              std::vector<ExploreConfig> configs, const std::string& slam) {
  ExploreRequest request;
  request.plan_path = saved(folder, plan);
  request.strategies = std::move(configs);
  request.slam = slam;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = folder / "out";
  return request;
}

inline ExplorationReport run(const ExploreRequest& request) {
  return explore(request, {}, core::silentProgress());
}

}  // namespace slam::explore
