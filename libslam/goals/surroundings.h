#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/drive.h"
#include "libslam/safety/obstacle_memory.h"

namespace slam::goals {

/// What is known of the obstacles near the robot: the newest scan, what earlier scans showed where the newest
/// one does not look (see ObstacleMemory), and what the bumper felt. Only what lies near is remembered, so
/// drift of the pose does little harm.
///
/// Three radii of the disc that has to fit, all around the robot's centre: no command may bring anything
/// nearer than guardRadius() (the footprint's circle, 2 cm and one standard deviation of the range); straight
/// ways are judged with passRadius(), boundaries are followed at followRadius(), which is larger by half of
/// and by the whole of `clearance_m`, so that what noise does to one does not change the judgement of the
/// other.
class Surroundings {
 public:
  /// `memory`: a name of obstacleMemoryNames(); `zone` is that of local_map.
  Surroundings(const robot::RobotOptions& robot, double clearance_m, double period_s,
               const std::string& memory = "short", const obstacles::LocalObstacleOptions& zone = {});

  void update(const lidar::Scan& scan, const core::Pose2& T_odom_robot);
  /// Further obstacles, robot frame, until the next update().
  void add(const std::vector<core::Point2>& p_robot);
  /// The bumper met something on the side to which the last command drove.
  void feel(const core::Pose2& T_odom_robot, bool ahead);

  double guardRadius() const { return guard_m_; }
  double passRadius() const { return guard_m_ + 0.5 * clearance_m_; }
  double followRadius() const { return guard_m_ + clearance_m_; }

  /// How far a disc can be shifted along a direction (robot frame), and what stops it.
  struct Way {
    double free_m;                     ///< +infinity when nothing is in the way
    std::optional<core::Point2> stop;  ///< robot frame
  };
  Way way(double direction_rad, double radius_m) const;
  double nearest_m() const;  ///< +infinity when nothing is known
  /// The nearest known point within `most_m`, robot frame.
  std::optional<core::Point2> nearestWithin(double most_m) const;
  const std::vector<core::Point2>& points() const { return points_; }

  /// The same command, slower where its arc would bring the disc of guardRadius() into something (from where
  /// the disc already is, it may only move away); down to a turn in place.
  robot::Command guarded(robot::Command command) const;
  /// One period towards a direction: a turn in place when it lies far aside, else an arc that ends in it.
  robot::Command towards(double direction_rad, double most_m) const;
  robot::Command turn(double angle_rad) const;
  robot::Command straight(double distance_m) const;
  robot::Command stand() const { return {0, 0, period_s_}; }
  /// The longest straight step of one period that methods plan with.
  double step_m() const;

 private:
  bool staysClear(const robot::Command& command) const;

  robot::RobotOptions robot_;
  double clearance_m_, period_s_, guard_m_;
  std::unique_ptr<safety::ObstacleMemory> memory_;
  std::vector<core::Point2> points_;  ///< robot frame
  std::vector<core::Point2> felt_odom_;
};

}  // namespace slam::goals
