#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/goals/goal_navigator.h"
#include "libslam/lidar/lidar.h"
#include "libslam/movers/living.h"
#include "libslam/mrptnav/reactive_navigator.h"
#include "libslam/record/step_observer.h"
#include "libslam/resources/manifest.h"
#include "libslam/robot/odometry_noise.h"
#include "libslam/sim/carry.h"
#include "libslam/table/table.h"
#include "libslam/world/plan.h"

namespace slam::reach {

/// All that decides a drive to a goal besides the plan, the places, the method and the seed.
struct ReachGoalConfig {
  robot::RobotOptions robot;
  lidar::LidarOptions lidar;                 ///< with a camera: the one that would give its scans
  std::optional<robot::FloorCamera> camera;  ///< looks in place of the lidar
  robot::OdometryOptions odometry;
  movers::LivingOptions living;
  goals::NavigateOptions navigate;
  mrptnav::ReactiveOptions mrpt_reactive;
  std::vector<sim::CarryOrder> carries;            ///< when and where somebody carries the robot
  std::vector<files::ParameterReport> parameters;  ///< every value and where it came from
};
/// Reads sections [robot], those of readSensor(), [odometry] [living] [events] [navigate] [lidar_bug]
/// [obstacles] [mrpt_reactive]; strict.
ReachGoalConfig readReachGoalConfig(const files::IniFile& config);

/// A navigator that is not one of the library's: its name in tables and folders, and what makes it, as
/// goals::makeGoalNavigator() does.
struct OwnNavigator {
  std::string name;
  std::function<std::unique_ptr<goals::GoalNavigator>(const goals::NavigateOptions&, const goals::GoalTask&)>
      make;
};

struct ReachGoalRequest {
  world::Plan plan;  ///< as it is on this [living] visit
  core::Pose2 T_world_start;
  core::Point2 p_world_goal;
  ReachGoalConfig config;
  std::vector<std::string> methods;  ///< names of goalMethodNames() or of `own`
  std::vector<OwnNavigator> own;     ///< known by name beside them, and before them
  std::string slam;                  ///< a SLAM method whose pose is used; "" = the wheels' odometry
  std::string methods_folder;        ///< of the SLAM methods
  std::string output;                ///< folder
  std::uint64_t seed = 1;
  bool overwrite = false;
  record::StepObserver* observer = nullptr;  ///< of every drive
};

struct StateChange {
  double time_s;  ///< since the start
  std::string from, to, why;
  core::Point2 p_world;                              ///< true place
  std::vector<core::Point2> p_world_projected = {};  ///< as GoalStep::p_robot_projected, from the true place
};

/// How one method fared.
struct GoalRun {
  std::string method;
  goals::GoalStatus status = goals::GoalStatus::kMoving;
  std::string reason;
  double time_s = 0, path_m = 0, goal_distance_m = 0;  ///< the true ones
  size_t collisions = 0;
  std::vector<sim::Carry> carries;
  size_t carries_left = 0;           ///< orders that the end came before
  core::Trajectory truth, estimate;  ///< both in the world frame, the estimate from the true start
  std::vector<StateChange> changes;
  /// Said to be reached and truly within kArrived_m of the goal; or said to be unreachable, and no way of the
  /// disc around the footprint leads there in the true plan, or none with the clearance that methods keep.
  bool right = false;
};
inline constexpr double kArrived_m = 0.5;

struct GoalComparison {
  std::vector<GoalRun> runs;
  std::optional<double> shortest_m;  ///< nothing: the goal cannot be reached
  table::Table table;
  int wrong = 0;  ///< runs that are not right
};

/// Drives to the goal once per method, the simulator in the loop, and writes into `output`:
///   METHOD/truth.tum trajectory.tum states.csv path.png   (the path coloured by the method's states)
///   METHOD/run.rawlog and the files beside it, as record() writes them
///   states.csv has every change of state; of lidar_bug also the places projected in its five directions
///   paths.png   scores.txt .md .tex .csv .json   manifest.json
/// The folder appears whole or not at all. Same request: the same bytes but for the manifest's times.
/// Errors: InputError for a start without room for the robot, a goal in a wall or outside the plan, an
/// unknown or doubled method, an existing folder without `overwrite`.
GoalComparison reachGoal(const ReachGoalRequest& request, resources::Manifest manifest,
                         core::Progress& progress);

/// One drive. `folder` (existing) gets what is recorded, see record(), with `manifest`; "" writes nothing.
GoalRun driveToGoal(const ReachGoalRequest& request, const std::string& method, core::Progress& progress,
                    const std::string& folder = "", const resources::Manifest& manifest = {});

/// "x y" or "x y yaw_deg" in metres and degrees. `flag` stands before errors (InputError).
core::Point2 parsePlace(const std::string& text, const std::string& flag);
core::Pose2 parsePose(const std::string& text, const std::string& flag);

/// Where a drive starts: as "x y yaw_deg" says, or "auto": a free place in the middle, with room around it
/// where there is such a place. Errors: malformed text, no free place (InputError).
core::Pose2 goalStart(const world::Plan& plan, const ReachGoalConfig& config, const std::string& text);

}  // namespace slam::reach
