#include "libslam/sweep/suite.h"

#include <sstream>

#include "libslam/files/files.h"
#include "libslam/record/generated_world.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/sweep/suite_reader.h"

namespace slam::sweep {

const files::ParameterTable<SuiteOptions>& SuiteOptions::table() {
  using O = SuiteOptions;
  static const files::ParameterTable<O> rows(
      "suite",
      {{"worlds", &O::worlds, "", {}, "buildings to simulate in"},
       {"logs", &O::logs, "", {}, "logs that exist already"},
       {"robots", &O::robots, kBuiltIn, {}, "the robot's body"},
       {"lidars", &O::lidars, kBuiltIn, {}, "the robot's lidar"},
       {"odometry", &O::odometry, kBuiltIn, {}, "how good its wheels are"},
       {"strategies", &O::strategies, kBuiltIn, {}, "where it goes"},
       {"faults", &O::faults, kBuiltIn, {}, "what goes wrong"},
       {"methods", &O::methods, "", {}, "the SLAM methods that map every log"},
       {"seeds", &O::seeds, "1", {}, "seeds of the simulation and of the methods: 1..10, 12"},
       {"baseline", &O::baseline, "", {}, "the method that the others are compared with; empty: the first"},
       {"metric",
        &O::metric,
        "ate_final_m",
        {"ate_final_m", "ate_rmse_m", "ate_max_m", "heading_rmse_deg", "rpe_1m_m", "rpe_1m_deg", "wall_f1",
         "free_iou", "wall_p95_m", "ghost_share", "relation_m", "relation_deg"},
        "the figure that ranks the methods"},
       {"failure_ate_m", &O::failure_ate_m, 0, 0, 1e6,
        "a run whose final path is farther off than this (ate_final_m) counts as failed; 0: never"},
       {"keep",
        &O::keep,
        "paths",
        {"paths", "all"},
        "of a run: paths, journal and map picture, or all that 'rasterslam run' writes"}});
  return rows;
}

SuiteOptions::SuiteOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<CellLimits>& CellLimits::table() {
  using O = CellLimits;
  static const files::ParameterTable<O> rows(
      "limits", {{"time_limit_s", &O::time_limit_s, 3600, 1, 10000000, "computing time (CPU) of one cell"},
                 {"wall_limit_s", &O::wall_limit_s, 14400, 0.001, 1e7, "time by the clock, for what hangs"},
                 {"memory_limit_mb", &O::memory_limit_mb, 4096, 1, 1e7,
                  "memory over what the program takes before it begins"}});
  return rows;
}

CellLimits::CellLimits() {
  table().setDefaults(*this);
}

std::string fullName(const SuiteMethod& method) {
  return method.parameters.empty() ? method.name : method.name + " " + method.parameters;
}

bool isSuiteFile(const std::string& path) {
  if (!resources::isYamlFile(path)) return resources::isConfigFile(path);
  std::istringstream lines(files::readTextFile(path));
  for (std::string line; std::getline(lines, line);)
    if (line.compare(0, 6, "suite:") == 0) return true;
  return false;  // a ROS map's
}

Suite readSuite(const std::string& path, const std::string& folder) {
  return SuiteReader(path, folder).read();
}

Suite readSuite(const files::IniFile& ini, const std::string& path, const std::string& folder) {
  return SuiteReader(ini, path, folder).read();
}

files::IniFile layered(const Suite& suite, const SuiteVariant& robot, const SuiteVariant& lidar,
                       const SuiteVariant& odometry, const SuiteVariant& strategy,
                       const SuiteVariant& fault) {
  files::IniFile config = suite.base;
  for (const auto* variant : {&robot, &lidar, &odometry, &strategy, &fault})
    config.overrideWith(variant->overlay);
  return config;
}

world::Plan loadWorld(const SuiteWorld& world) {
  if (!world.plan_path.empty()) return world::loadPlan(world.plan_path);
  world::Plan plan = record::generateWorld(world.kind, world.building, world.seed).plan;
  plan.name = world.name;
  return plan;
}

std::string planSha256(const world::Plan& plan) {
  std::ostringstream text;
  text << plan.columns << ' ' << plan.rows << ' ' << files::formatNumber(plan.resolution_m) << ' '
       << files::formatNumber(plan.T_frame_raster.x) << ' ' << files::formatNumber(plan.T_frame_raster.y)
       << ' ' << files::formatNumber(plan.T_frame_raster.phi) << '\n';
  for (const auto& door : plan.doors)
    text << door.x0 << ' ' << door.y0 << ' ' << door.x1 << ' ' << door.y1 << '\n';
  text.write(reinterpret_cast<const char*>(plan.cells.data()),
             static_cast<std::streamsize>(plan.cells.size()));
  text.write(reinterpret_cast<const char*>(plan.materials.data()),
             static_cast<std::streamsize>(plan.materials.size()));
  return resources::sha256(text.str());
}

}  // namespace slam::sweep
