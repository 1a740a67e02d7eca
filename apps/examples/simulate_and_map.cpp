// Simulates a robot that explores a flat, and maps what it sensed: simulate_and_map [METHOD]
#include <cstdio>
#include <string>

#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/record.h"
#include "libslam/resources/resources.h"

int main(int argc, char** argv) try {
  const std::string method_name = argc > 1 ? argv[1] : "graph";
  slam::files::IniFile
      settings;  // all else as built in; keys as `rasterslam simulate --print-config` prints them
  settings.setFromArgument("simulation.duration_s=90", "settings");
  const auto plan = slam::world::loadPlan(slam::resources::resolvePlan("flat"));
  const auto config = slam::record::readRecordConfig(settings);
  const auto recording =
      slam::record::record(plan, config, /*seed=*/7, "run.rawlog", {}, slam::core::silentProgress());
  std::printf("simulated %zu scans, %.1f m\n", recording.scans, recording.path_length_m);

  const auto method_config =
      slam::mapping::loadMethodConfig(slam::resources::configsFolder() + "/methods", method_name);
  auto method = slam::mapping::makeMapBuilder(method_config, method_name, /*seed=*/1);
  slam::logs::LogReader log("run.rawlog");
  slam::core::Pose2 T_map_robot;
  while (const auto entry = log.next())
    T_map_robot =
        slam::mapping::processScan(method, entry->scan, entry->T_previous_robot, entry->has_odometry);
  slam::mapping::finishMap(method);
  slam::mapping::saveMaps(method, ".");  // map.yaml, map.png, map.gridmap.gz, map.simplemap
  std::printf("%s ends at x %.2f m, y %.2f m, %.1f degrees from its start\n", method_name.c_str(),
              T_map_robot.x, T_map_robot.y, slam::core::radToDeg(T_map_robot.phi));
} catch (const std::exception& error) {
  std::fprintf(stderr, "simulate_and_map: %s\n", error.what());
  return 1;
}
