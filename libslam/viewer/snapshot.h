#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"
#include "libslam/viewer/layers.h"

namespace slam::viewer {

/// All that a scene shows of one moment, as plain data: what may be handed from one thread to another, and
/// what tests make by hand. The scene's frame is the world where the truth is known, else the map's.
struct Snapshot {
  std::string title;   ///< what runs: "explore flat"
  std::string method;  ///< who estimates and decides: "icp_exact, nearest_frontier"
  std::string note;    ///< what there is to say now; "" nothing
  double time_s = 0;   ///< since the first scan
  std::size_t scans = 0;
  std::size_t collisions = 0;

  lidar::Scan scan;  ///< the newest
  core::Pose2 T_scene_map, T_map_robot;
  std::optional<core::Pose2> T_scene_truth;  ///< where the robot truly is, when that is known

  core::Trajectory path;                                ///< map frame
  core::Trajectory truth;                               ///< scene frame
  std::shared_ptr<const gridmap::OccupancyRaster> map;  ///< nullptr: none is built. Shared with later moments
  std::vector<core::Pose2> particles;                   ///< map frame
  std::vector<core::Point2> nodes;                      ///< map frame, as the next two
  std::vector<Connection> edges, loops;
  std::optional<LocalObstacles> obstacles;  ///< robot frame
  std::optional<Candidates> candidates;     ///< map frame
  std::optional<StrategicView> strategic;   ///< robot frame
  std::vector<Body> people;                 ///< scene frame
};

}  // namespace slam::viewer
