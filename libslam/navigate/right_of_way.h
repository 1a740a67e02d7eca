#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"
#include "libslam/paths/path_follower.h"
#include "libslam/robot/drive.h"

namespace slam::navigate {

/// Another robot that is seen, map frame of the one that sees it. All robots of a team are alike.
struct NeighbourRobot {
  int number = 0;  ///< in the team, from 0; the smaller one has the right of way
  core::Point2 p_map;
  bool wants_to_drive = false;      ///< at the last scan; a lamp on it says so
  std::vector<core::Point2> way{};  ///< the rest of its path where it is heard; else empty
};

/// Keeps robots of a team from running into each other and from waiting for each other for ever. To the
/// driver other robots are no obstacles: they are left out of the scans that it sees. This looks at what it
/// wants to do, and lets it, or has the robot stand, or drive out of the way.
///
/// Stand: no command may end nearer to a neighbour than two radii, kGap_m, and one period's way, the robot
/// without the right of way one more, unless it leads away from it. Both act on the same scan: whatever they
/// do, they do not touch.
/// Give way: who is held up for its patience drives to the nearest place that is off the neighbours' known
/// ways and kAside_m away from them, by its own map, and waits there until they are past, at most kLongest_s.
/// The patience is the longer the more right of way a robot has, so of two one moves first; and when it
/// cannot (a dead end), the other will. Who wants nothing gives way to any that comes near and wants to
/// drive.
class RightOfWay {
 public:
  /// `number` of `team`.
  RightOfWay(const robot::RobotOptions& robot, double period_s, int number, int team);

  struct Answer {
    robot::Command command;
    bool gave_way = false;  ///< it has just ended: what the driver was about is to be decided anew
  };
  /// While it gives way the driver has no say: do not ask it.
  bool givesWay() const { return waiting_ || follower_.has_value(); }
  /// The command to carry out. `wanted` is the driver's, or nullopt while givesWay(). `map` is asked only
  /// when a place to give way to is looked for.
  Answer next(const std::optional<robot::Command>& wanted, const lidar::Scan& scan,
              const core::Pose2& T_map_robot, const std::vector<NeighbourRobot>& neighbours,
              const std::function<gridmap::OccupancyRaster()>& map);

 private:
  bool mayDo(const robot::Command& command, const core::Pose2& T_map_robot,
             const std::vector<NeighbourRobot>& neighbours) const;
  bool isPressed(const core::Pose2& T_map_robot, const std::vector<NeighbourRobot>& neighbours) const;
  void leave(const core::Pose2& T_map_robot, const std::vector<NeighbourRobot>& neighbours,
             const gridmap::OccupancyRaster& map);
  std::optional<robot::Command> giveWay(const lidar::Scan& scan, const core::Pose2& T_map_robot,
                                        const std::vector<NeighbourRobot>& neighbours);
  double contact_m() const { return 2 * robot::circumscribedRadius(robot_); }
  robot::Command stand() const { return {0, 0, period_s_}; }

  robot::RobotOptions robot_;
  double period_s_, patience_s_;
  int number_;
  double held_s_ = 0, pressed_s_ = 0;
  std::optional<paths::PathFollower> follower_;  ///< on its way out of the way
  bool waiting_ = false;                         ///< there
  double away_s_ = 0;                            ///< since it began to give way
};
inline constexpr double kGap_m = 0.05, kAside_m = 1.2, kLongest_s = 8.0;

}  // namespace slam::navigate
