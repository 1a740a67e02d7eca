#pragma once
#include <cstdint>
#include <deque>
#include <vector>

#include "libslam/choices/place_set.h"
#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/obstacles/lidar_view.h"
#include "libslam/paths/free_space.h"
#include "libslam/robot/drive.h"

namespace slam::choices {

/// People who pass, as a map made meanwhile shows them: as walls, until the robot looks there again.
///
/// Somebody has come where a scan shows something no larger than a person, apart from all else, and a scan of
/// a moment before had looked through that place. Two scans tell that, whatever the map's errors have grown
/// to. By as much as the pose has moved otherwise in between than the robot was told to, so much of what lies
/// beside the place must have been looked through, too. Who has come, and is not seen any more, is taken to
/// have gone; once that leaves nothing to do, so is whatever is no larger than a person. While nobody has
/// come nothing is taken out of any map.
class Passers {
 public:
  Passers();
  /// What the robot was told to do since the scan before.
  void tell(const robot::Command& command) { T_start_told_ = T_start_told_ * robot::driveMotion(command); }
  /// Every scan in turn, with the robot's pose and the cells' side of the maps to come. Needs stamps that run
  /// on.
  void see(const lidar::Scan& scan, const core::Pose2& T_map_robot, double cell_m);
  /// Where the people of the newest scan may reach, map frame: a lidar sees legs, and bodies are wider.
  const std::vector<core::Point2>& bodies() const { return bodies_; }
  bool areAbout() const;
  /// From now on small things that are not seen now are taken for people.
  void suspectSmallThings() { are_small_things_suspected_ = true; }
  bool areSmallThingsSuspected() const { return are_small_things_suspected_; }
  /// Makes free what they have left behind. Answers with a block that holds it all.
  paths::CellBlock takeOutOf(paths::FreeSpace& space) const;

 private:
  /// What a scan saw, and from where.
  struct Look {
    double time_s;
    core::Pose2 T_map_robot, T_start_told, T_robot_lidar;
    obstacles::LidarView view;
  };
  const Look* before(double time_s);
  core::Pose2 slip(const Look& since, const core::Pose2& T_map_robot) const;
  static bool isLookedThrough(const Look& look, const core::Pose2& slip, const core::Point2& p_map);
  paths::CellBlock takeOutSmallThings(paths::FreeSpace& space) const;

  obstacles::SectorOptions all_round_;
  core::Pose2 T_start_told_;  ///< where the robot would be if it had done what it was told
  std::deque<Look> looks_;    ///< of the last moments, the oldest first
  int scans_with_newcomers_ = 0;
  PlaceSet passed_;    ///< cells in or beside which somebody was
  PlaceSet seen_now_;  ///< in or beside which the newest scan has a return
  std::vector<core::Point2> bodies_;
  bool are_small_things_suspected_ = false;
};

}  // namespace slam::choices
