#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/lidar/lidar.h"
#include "libslam/movers/living.h"
#include "libslam/record/step_observer.h"
#include "libslam/resources/manifest.h"
#include "libslam/robot/camera.h"
#include "libslam/robot/drive.h"
#include "libslam/robot/odometry_noise.h"
#include "libslam/sim/carry.h"
#include "libslam/sim/simulator.h"
#include "libslam/strategies/strategy.h"
#include "libslam/world/plan.h"

namespace slam::record {

/// Section [simulation].
struct SimulationOptions {
  double duration_s;     ///< of the robot's time, at most
  std::string start;     ///< "auto", or "x_m,y_m,yaw_deg" in the world frame; blanks do as commas
  std::string log_form;  ///< action | observation
  SimulationOptions();
  static const files::ParameterTable<SimulationOptions>& table();
};

/// All that decides a recording besides the plan and the seed.
struct RecordConfig {
  robot::RobotOptions robot;
  lidar::LidarOptions lidar;                  ///< with a camera: the one that would give its scans
  std::vector<sim::NamedLidar> other_lidars;  ///< of the sections [lidar NAME]
  std::optional<robot::FloorCamera> camera;   ///< looks in place of the lidar
  robot::OdometryOptions odometry;
  strategies::StrategyOptions strategy;
  movers::LivingOptions living;
  SimulationOptions simulation;
  std::vector<sim::CarryOrder> carries;            ///< when and where somebody carries the robot
  std::vector<files::ParameterReport> parameters;  ///< every value and where it came from
};

/// Reads sections [robot], those of readSensor(), [odometry] [strategy] [obstacles] [living] [simulation]
/// [events]; strict but for `other_sections`, which
/// someone else reads.
RecordConfig readRecordConfig(const files::IniFile& config,
                              const std::vector<std::string>& other_sections = {});

/// Where the robot starts, world frame: as [simulation] start says; "auto" is a free place in the middle,
/// with the strategy's clearance where there is one. Errors: no free place, malformed text (InputError).
core::Pose2 startPose(const world::Plan& plan, const RecordConfig& config);

/// What the robot finds on this [living] visit: the plan, its furniture moved visit - 1 times.
world::Plan planOfVisit(const world::Plan& plan, const movers::LivingOptions& living, std::uint64_t seed);

/// What came out of a recording.
struct Recording {
  std::size_t scans = 0;
  std::vector<sim::Collision> collisions;
  std::vector<sim::Carry> carries;
  std::size_t carries_left = 0;  ///< orders that the end came before
  double duration_s = 0, path_length_m = 0;
  std::vector<std::string> files;
};

/// Lets the robot explore the plan and writes, for log_path "a/run.rawlog":
///   run.rawlog            what the robot sensed, for MRPT's programs and ours
///   run.rawlog.GT.txt     the truth as MRPT's simulator writes it (relative to the start)
///   run.gt.tum            the truth as TUM (world frame)
///   run.operations.txt    the original document's operation log
///   run.movers.csv        where people and doors were, when there are any that move: see MoversLog
///   run.collisions.csv    when and where a command was cut short, when any was: see readCollisions()
///   run.carries.csv       when the robot was kidnapped, from where and where to, if it was: see
///                         readCarryFile()
///   run.plan.yaml, .png   the true plan, when it is not the given one: a [living] visit after the first
///   run.manifest.json     how to make it again
/// Each file is written beside and renamed; an error or an interrupt leaves none of them.
/// Same plan, config and seed: the same bytes (but for the times in the manifest). InputError for a strategy
/// that needs a map: explore() builds one.
Recording record(const world::Plan& given_plan, const RecordConfig& config, std::uint64_t seed,
                 const std::string& log_path, resources::Manifest manifest, core::Progress& progress,
                 StepObserver* observer = nullptr);

/// What is done next: a command to the robot, before which it may be kidnapped.
struct Order {
  Order(const robot::Command& to_robot, bool whole = false) : command(to_robot), is_whole(whole) {}
  robot::Command command;
  bool is_whole;  ///< a command of its own in the operation log, even where the one before was alike
  std::optional<core::Pose2>
      T_world_carried;  ///< where somebody puts the robot down; a place that is free by the plan
};
/// The next order by what the robot senses; nullopt ends the recording.
using Commander = std::function<std::optional<Order>(const sim::Sensed& sensed)>;
/// The same with commands from elsewhere, such as from someone at the keys, instead of a strategy.
Recording recordCommands(const world::Plan& given_plan, const RecordConfig& config, std::uint64_t seed,
                         const std::string& log_path, resources::Manifest manifest, core::Progress& progress,
                         const Commander& commander, StepObserver* observer = nullptr);

}  // namespace slam::record
