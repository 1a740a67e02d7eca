#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/deskew.h"
#include "libslam/lidar/lidar.h"
#include "libslam/lidar/scan.h"
#include "libslam/movers/living.h"
#include "libslam/movers/scene.h"
#include "libslam/robot/drive.h"
#include "libslam/robot/odometer.h"
#include "libslam/sim/camera_sensor.h"
#include "libslam/sim/carry.h"
#include "libslam/sim/lidar_sensor.h"
#include "libslam/sim/recent_path.h"
#include "libslam/world/plan.h"

namespace slam::sim {

/// A lidar beside the first one.
struct NamedLidar {
  std::string label;  ///< of its scans, not "LASER", which is the first one's
  lidar::LidarOptions options;
};

/// What another lidar than the first sees.
struct OtherScan {
  std::string label;
  lidar::Scan scan;
  std::optional<lidar::Sweep> sweep;
};

/// What the robot senses after a command. Nothing of the truth is in it.
struct Sensed {
  lidar::Scan scan;
  core::Pose2 T_odom_robot;      ///< dead reckoning from the start
  core::Pose2 T_previous_robot;  ///< its last increment
  bool collided = false;         ///< the bumper: the command was cut short by an obstacle
  std::optional<lidar::Sweep> sweep =
      {};  ///< of `scan`, where the lidar's beams are not all at once: lidar::sweepOf()
  std::vector<OtherScan> others =
      {};  ///< of the lidars that were mounted beside the first, of the same moment
};

/// A collision, for the report.
struct Collision {
  double time_s;  ///< of the moment of contact, not of the end of the command
  core::Pose2 T_world_robot;
  bool with_robot = false;  ///< with another robot (setOthers()), not with a wall, a door or a person
};

/// The true world in motion: advances the truth by one command and senses it. Has its own clock (start_time_s
/// plus the durations of the commands, summed in whole nanoseconds so that nothing drifts), its own random
/// streams (those of LidarSensor and robot::Odometer), and no noise on the truth. The disc around the
/// footprint never enters a wall: a command that would collide is cut at the last free moment (to 1 mm of
/// travel) and recorded; time still passes. A turn in place never collides, for the disc is free. Where
/// people walk or doors move, they do so at whole ticks of the world's own clock, however time is cut into
/// commands, and stand still in between: driving into them is a collision, and they never walk or close into
/// the robot. Between two checks of the path (at most a quarter of a cell or 1 cm apart) the disc may cut a
/// wall's corner by less than 0.1 mm.
///
/// Chance of the places that orders leave open: stream "carry".
/// The robot may be kidnapped (carryAt(), carryNow()): at that moment, also amid a command, the truth jumps.
/// The wheels do not notice: dead reckoning goes by the command alone, and the rest of the command is driven
/// from the new place, unless an obstacle has ended it. A place where a person stands or a door is shut just
/// then is waited for: the robot is put down before the first command that finds it free.
///
/// Errors: lidar options that contradict each other (lidar::requireSensible()); start not finite, in a wall,
/// outside the plan or nearer to either than the disc's radius (InputError naming the pose and the radius); a
/// command that is not finite or has a negative duration (ContractError).
class Simulator {
 public:
  static constexpr double kStartTime_s = 1700000000.0;

  /// Keeps a reference to `plan`, which must outlive it and not change. `living`: what else moves; of it the
  /// visit is not the simulator's to know, `plan` is what this visit finds. `camera`: what looks in place of
  /// the lidar; of `lidar`, which should be robot::asLidar() then, nothing is used. Makes a
  /// rays::SectorCaster: some milliseconds per million cells, and 8 bytes per cell.
  Simulator(const world::Plan& plan, const robot::RobotOptions& robot, const lidar::LidarOptions& lidar,
            const robot::OdometryOptions& odometry, const core::Pose2& start, std::uint64_t seed,
            double start_time_s = kStartTime_s, const movers::LivingOptions& living = {},
            const std::optional<robot::FloorCamera>& camera = {});
  Simulator(world::Plan&&, const robot::RobotOptions&, const lidar::LidarOptions&,
            const robot::OdometryOptions&, const core::Pose2&, std::uint64_t, double = 0,
            const movers::LivingOptions& = {}, const std::optional<robot::FloorCamera>& = {}) = delete;

  /// Mounts one more lidar, which then looks whenever the first does (its own rate says only how long its
  /// sweep takes). Before the first look. Its random streams are of its label, so that the first one's noise
  /// stays as it was.
  void mount(const NamedLidar& lidar, std::uint64_t seed);

  /// The first look, before any command. Looking again draws new noise and moves nothing else.
  Sensed sense();
  /// Carries out one command and looks. A command of duration 0 only looks.
  Sensed step(const robot::Command& command);
  /// The first half of step(): carries out the command; sense() is the second. For several robots in one
  /// world, which all move before any looks.
  void drive(const robot::Command& command);

  /// Where other robots stand from now on, world frame: they are met by rays and bumped into as people are,
  /// and stand still until told otherwise. Each robot of a team has a simulator of its own, and all are told
  /// of each other.
  void setOthers(const std::vector<movers::Disc>& robots) { scene_.setRobots(robots); }

  /// Has the robot kidnapped at the moments of `orders` (since the first scan; may be called once, before the
  /// first command). Errors: InputError for a place without room for the robot, as for the start.
  void carryAt(const std::vector<CarryOrder>& orders);
  /// The same before the next command. An order that still waits for its place is dropped.
  void carryNow(const core::Pose2& T_world_robot);

  double time_s() const;
  const core::Pose2& truth() const { return T_world_robot_; }  ///< for the recorder only
  const std::vector<Collision>& collisions() const { return collisions_; }
  const movers::Scene& scene() const { return scene_; }           ///< likewise
  const std::vector<Carry>& carries() const { return carries_; }  ///< that took place, in the order of time
  /// Orders that are not carried out yet.
  std::size_t waitingCarries() const { return pending_carries_.size(); }

 private:
  struct PendingCarry {
    std::int64_t time_ns;  ///< of the simulator's own clock
    core::Pose2 T_world_robot;
    CarryOrder::Where where = CarryOrder::Where::kGiven;
  };
  /// Where an order puts the robot down; another place at every call, of those that it leaves to chance.
  core::Pose2 placeOf(const PendingCarry& carry);

  /// Carries out the orders that are due, as far as their places are free.
  void carryIfDue();
  /// Moves the truth by a command, or by a part of one, and time with it. Returns the seconds of it that were
  /// driven.
  double advance(const robot::Command& command);
  /// Seconds of the command until the disc would bump into something as it stands now, looking from from_s
  /// on, where it is free; to_s when it does not until then.
  double freeDuration(const robot::Command& command, double from_s, double to_s) const;
  /// The same over the whole command while the world goes on.
  double driveInLivingWorld(const robot::Command& command);

  movers::Scene scene_;
  robot::RobotOptions robot_;
  struct MountedLidar {
    std::string label;
    std::optional<lidar::Sweep> sweep;
    LidarSensor sensor;
  };
  LidarSensor lidar_;
  std::optional<lidar::Sweep> sweep_;  ///< of lidar_
  std::vector<MountedLidar> others_;
  std::optional<CameraSensor> camera_;
  robot::Odometer odometer_;
  RecentPath path_;
  core::Pose2 T_world_robot_, T_odom_robot_, T_previous_robot_;
  double start_time_s_;
  std::int64_t elapsed_ns_ = 0;
  bool collided_ = false;
  std::vector<Collision> collisions_;
  std::vector<PendingCarry> pending_carries_;  ///< by time
  core::RandomStream carry_random_;
  std::vector<core::Point2> visited_;  ///< after every command, while orders are pending
  std::vector<Carry> carries_;
};

}  // namespace slam::sim
