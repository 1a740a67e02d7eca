#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/drive.h"

namespace slam::paths {

/// Drives along a path of the map: turns in place to the next waypoint, drives straight at it, turns at the
/// end so that the lidar covers a place to look at. The path is never trusted: the disc around the footprint
/// has to fit by the newest scan (and by what is remembered, robot frame: see ObstacleMemory), the speed
/// falls near to obstacles, and a short sidestep is tried where something is in the way.
class PathFollower {
 public:
  enum class Status { kFollowing, kArrived, kBlocked };
  struct Step {
    Status status;
    robot::Command command;  ///< stands still unless kFollowing
  };

  PathFollower() = default;  ///< has arrived
  PathFollower(std::vector<core::Point2> path_map, std::optional<core::Point2> look_at_map)
      : path_(std::move(path_map)), look_at_(look_at_map) {}
  Step next(const lidar::Scan& scan, const core::Pose2& T_map_robot, const robot::RobotOptions& robot,
            double slow_clearance_m, double period_s, const std::vector<core::Point2>& remembered = {});
  /// Index into the path of the waypoint that it drives to; its size when only the turn is left.
  std::size_t waypoint() const { return waypoint_; }

 private:
  bool advanceWaypoint(const core::Pose2& T_map_robot);
  std::optional<core::Point2> sidestep(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                                       const robot::RobotOptions& robot, double towards_rad,
                                       const std::vector<core::Point2>& remembered);
  bool mustTurn(double error_rad, double rest_m, double most_rad);

  std::vector<core::Point2> path_;
  std::optional<core::Point2> look_at_;
  std::optional<core::Point2> detour_;  ///< end of a sidestep, map frame
  std::size_t waypoint_ = 0;
  bool turning_ = false, sighted_ = false;
  int sidesteps_ = 0;     ///< since the last progress
  double nearest_m_ = 0;  ///< to the waypoint when the last sidestep began
};

}  // namespace slam::paths
