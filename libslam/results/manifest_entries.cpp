#include "libslam/results/manifest_entries.h"

#include "libslam/files/parameters.h"

namespace slam::results {

const std::map<std::string, std::string>& fileNotes() {
  static const std::map<std::string, std::string> notes = {
      {"trajectory.tum", "estimated pose of every scan, TUM form: rasterslam eval, evo"},
      {"trajectory_final.tum", "the final path, after all corrections: rasterslam eval --relations, evo"},
      {"covariances_final.csv", "the same of the poses of trajectory_final.tum"},
      {"covariances.csv",
       "how sure the method says that it is of each of these poses: x, y (m), phi (rad), map frame"},
      {"map.yaml", "ROS map: map_server, ros-map-yaml2mrpt; its picture is map.png"},
      {"map.png", "the map as a picture"},
      {"map.gridmap.gz", "MRPT occupancy grid: pf-localization, GridmapNavSimul"},
      {"map.simplemap", "MRPT key frames: robot-map-gui, observations2map, pf-localization"},
      {"graph.g2o", "the pose graph: rasterslam graph, g2o, MRPT's graph-slam"},
      {"map.3Dscene",
       "map, path, last scan, and particles or graph with loops, in 3D: rasterslam view --mrpt"},
      {"journal.csv", "what the method says of its work: matches, loops, corrections, by scan"},
      {"timing.csv", "CPU milliseconds of every scan"},
      {"printed.txt", "what the external program printed"},
  };
  return notes;
}

void describeLidar(const lidar::Scan& scan, std::map<std::string, std::string>& results) {
  results["lidar.beams"] = std::to_string(scan.ranges_m.size());
  results["lidar.first_angle_rad"] = files::formatNumber(scan.first_angle_rad);
  results["lidar.step_rad"] = files::formatNumber(scan.step_rad);
  results["lidar.max_range_m"] = files::formatNumber(scan.max_range_m);
  results["lidar.mount_x_m"] = files::formatNumber(scan.T_robot_lidar.x);
  results["lidar.mount_y_m"] = files::formatNumber(scan.T_robot_lidar.y);
  results["lidar.mount_yaw_rad"] = files::formatNumber(scan.T_robot_lidar.phi);
}

void describePose(const std::string& name, const core::Pose2& pose,
                  std::map<std::string, std::string>& results) {
  results[name + ".x_m"] = files::formatNumber(pose.x);
  results[name + ".y_m"] = files::formatNumber(pose.y);
  results[name + ".yaw_rad"] = files::formatNumber(pose.phi);
}

void describeSelfScore(const SelfScore& score, std::map<std::string, std::string>& results) {
  results["self.mean_map_entropy"] = files::formatNumber(score.sharpness.mean_map_entropy);
  results["self.wall_thickness_m"] = files::formatNumber(score.sharpness.wall_thickness_m);
  results["self.on_wall_share"] = files::formatNumber(score.agreement.on_wall_share);
  results["self.through_wall_share"] = files::formatNumber(score.agreement.through_wall_share);
}

void describeStop(const Stop& stop, std::map<std::string, std::string>& results) {
  results["status"] = "incomplete";
  results[core::wordOf(eventOf(stop))] = stopText(stop);
}

}  // namespace slam::results
