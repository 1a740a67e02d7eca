// Finds a robot in a map of before, from anywhere, and follows it: localise_in_map MAP.simplemap LOG
#include <cstdio>

#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/resources/resources.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: localise_in_map MAP.simplemap LOG\n");
    return 2;
  }
  const auto config = slam::mapping::loadMethodConfig(slam::resources::configsFolder() + "/methods", "graph");
  auto method = slam::mapping::makeMapBuilder(config, "graph", /*seed=*/1);
  // The map stays as it is; nobody says where the robot is at first.
  slam::mapping::continueMap(method, argv[1], std::nullopt, /*keep_map=*/true);
  slam::logs::LogReader log(argv[2]);
  slam::core::Pose2 T_map_robot;
  int scans = 0;
  for (; const auto entry = log.next(); ++scans)
    T_map_robot =
        slam::mapping::processScan(method, entry->scan, entry->T_previous_robot, entry->has_odometry);

  // Until it is found, its pose is what the wheels make of some start in the map.
  int found_at = -1;
  for (const auto& said : slam::mapping::journalOf(method)) {
    if (said.event == slam::core::JournalEvent::kLost) found_at = -1;
    if (said.event == slam::core::JournalEvent::kRecovered && found_at < 0) found_at = said.scan;
  }
  if (found_at < 0) {
    std::printf("not found after %d scans\n", scans);
    return 4;
  }
  std::printf("found at scan %d; after %d scans at x %.2f m, y %.2f m, %.1f degrees in the map\n", found_at,
              scans, T_map_robot.x, T_map_robot.y, slam::core::radToDeg(T_map_robot.phi));
} catch (const std::exception& error) {
  std::fprintf(stderr, "localise_in_map: %s\n", error.what());
  return 1;
}
