#include "libslam/mrptnav/reactive_navigator.h"

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/Clock.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <optional>
#include <system_error>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/goals/guarded_navigator.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::mrptnav {
namespace {

using goals::GoalStatus;
using goals::GoalStep;
using mrpt::kinematics::CVehicleVelCmd;
using mrpt::kinematics::CVehicleVelCmd_DiffDriven;

constexpr double kEpoch_s = 1e9;                      // MRPT takes a time of 0 for none
constexpr double kReachShare = 0.8;                   // of look_ahead_m: paths that bend end nearer
constexpr double kStride_m = 0.5;                     // of the target ahead
constexpr double kApproach_m = 0.5;                   // MRPT's own default of targetAllowedDistance
constexpr double kFarAside_rad = core::degToRad(60);  // a turn in place is shorter than MRPT's arc
constexpr double kFacing_rad = core::degToRad(15);
constexpr double kFreeAhead_m = 1.0;
constexpr double kStuck_s = 1.0;
constexpr double kStanding_mps = 0.02;  // less is a command that was all but cut off

/// MRPT's clock shows the robot's time while this lives.
class SimulatedClock {
 public:
  explicit SimulatedClock(double time_s) : before_(mrpt::Clock::getActiveClock()) {
    mrpt::Clock::setSimulatedTime(mrpt::Clock::fromDouble(time_s));
    mrpt::Clock::setActiveClock(mrpt::Clock::Simulated);
  }
  ~SimulatedClock() { mrpt::Clock::setActiveClock(before_); }
  SimulatedClock(const SimulatedClock&) = delete;
  SimulatedClock& operator=(const SimulatedClock&) = delete;

 private:
  mrpt::Clock::Source before_;
};

/// The robot as MRPT's navigation sees it: what was sensed last, and the speeds that it was told.
class RobotForMrpt : public mrpt::nav::CRobot2NavInterface {
 public:
  RobotForMrpt() { setMinLoggingLevel(mrpt::system::NUMBER_OF_VERBOSITY_LEVELS); }

  void sense(const std::vector<core::Point2>& points, const core::Pose2& T_odom_robot, double time_s) {
    obstacles_.clear();
    for (const auto& p : points)
      obstacles_.insertPoint(static_cast<float>(p.x), static_cast<float>(p.y), 0.0F);
    T_odom_robot_ = T_odom_robot;
    time_s_ = time_s;
  }
  /// What the robot does until the next look; MRPT may have asked for more.
  void drive(const robot::Command& command) { driven_ = command; }

  robot::Command wanted(double period_s) const { return {speed_mps_, turn_rate_radps_, period_s}; }

  bool getCurrentPoseAndSpeeds(mrpt::math::TPose2D& pose, mrpt::math::TTwist2D& velocity,
                               mrpt::system::TTimeStamp& stamp, mrpt::math::TPose2D& odometry,
                               std::string& /*frame*/) override {
    pose = odometry = lidar::toMrpt(T_odom_robot_);
    velocity = {driven_.speed_mps * core::cos(T_odom_robot_.phi),
                driven_.speed_mps * core::sin(T_odom_robot_.phi), driven_.turn_rate_radps};
    stamp = mrpt::Clock::now();
    return true;
  }
  bool changeSpeeds(const CVehicleVelCmd& command) override {
    const auto* speeds = dynamic_cast<const CVehicleVelCmd_DiffDriven*>(&command);
    if (!speeds) return false;
    speed_mps_ = speeds->lin_vel;
    turn_rate_radps_ = speeds->ang_vel;
    return true;
  }
  bool stop(bool /*is_emergency*/) override {
    speed_mps_ = turn_rate_radps_ = 0;
    return true;
  }
  CVehicleVelCmd::Ptr getEmergencyStopCmd() override { return getStopCmd(); }
  CVehicleVelCmd::Ptr getStopCmd() override { return std::make_shared<CVehicleVelCmd_DiffDriven>(); }
  bool senseObstacles(mrpt::maps::CSimplePointsMap& obstacles, mrpt::system::TTimeStamp& stamp) override {
    obstacles = obstacles_;
    stamp = mrpt::Clock::now();
    return true;
  }
  double getNavigationTime() override { return time_s_; }
  void resetNavigationTimer() override {}
  // The events' own versions print.
  void sendNavigationStartEvent() override {}
  void sendNavigationEndEvent() override {}
  void sendNavigationEndDueToErrorEvent() override {}
  void sendWaySeemsBlockedEvent() override {}
  void sendApparentCollisionEvent() override {}
  void sendCannotGetCloserToBlockedTargetEvent() override {}

 private:
  mrpt::maps::CSimplePointsMap obstacles_;
  core::Pose2 T_odom_robot_;
  robot::Command driven_;
  double time_s_ = 0;
  double speed_mps_ = 0, turn_rate_radps_ = 0;
};

/// Silent, and without its stopwatch: MRPT adds the measured duration of its calls to simulated times.
class Navigation : public mrpt::nav::CReactiveNavigationSystem {
 public:
  explicit Navigation(mrpt::nav::CRobot2NavInterface& robot)
      : CReactiveNavigationSystem(robot, false, false) {
    setMinLoggingLevel(mrpt::system::NUMBER_OF_VERBOSITY_LEVELS);
    m_timlog_delays.disable();
  }
};

/// The circle as MRPT wants shapes: coordinates of an octagon around it.
std::string octagon(double radius_m, double (*coordinate)(double)) {
  const double corner_m = radius_m / core::cos(core::kPi / 8);
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += files::formatNumber(corner_m * coordinate((i + 0.5) * core::kPi / 4)) + " ";
  return text;
}

/// MRPT's file with our robot in it.
mrpt::config::CConfigFileMemory configurationFor(const ReactiveOptions& options,
                                                 const goals::GoalTask& task) {
  mrpt::config::CConfigFileMemory config(files::readTextFile(options.config));
  const std::string reactive = "CReactiveNavigationSystem", common = "CAbstractPTGBasedReactive";
  const double radius_m = robot::circumscribedRadius(task.robot) + options.clearance_m;
  const double turn_rate_degps = core::radToDeg(task.robot.max_turn_rate_radps);
  config.write(common, "robotMax_V_mps", task.robot.max_speed_mps);
  config.write(common, "robotMax_W_degps", turn_rate_degps);
  config.write(common, "ref_distance", options.look_ahead_m);
  config.write(reactive, "RobotModel_shape2D_xs", octagon(radius_m, core::cos));
  config.write(reactive, "RobotModel_shape2D_ys", octagon(radius_m, core::sin));
  config.write(reactive, "RobotModel_circular_shape_radius", radius_m);
  // Its alarm starts anew with every aim that it is given; ours does not.
  config.write("CAbstractNavigator", "alarm_seems_not_approaching_target_timeout", 1e9);
  const int families = config.read_int(reactive, "PTG_COUNT", 0);
  if (families < 1)
    throw core::InputError(options.config + ": key 'PTG_COUNT' of section [" + reactive +
                           "] is missing, expected MRPT's configuration of its reactive navigation");
  for (int i = 0; i < families; ++i) {
    const std::string family = "PTG" + std::to_string(i) + "_";
    config.write(reactive, family + "refDistance", options.look_ahead_m);
    config.write(reactive, family + "v_max_mps", task.robot.max_speed_mps);
    config.write(reactive, family + "w_max_dps", turn_rate_degps);
  }
  return config;
}

class ReactiveNavigator : public goals::GuardedNavigator {
 public:
  ReactiveNavigator(const ReactiveOptions& options, const goals::NavigateOptions& navigate_options,
                    const goals::GoalTask& task)
      : GuardedNavigator(navigate_options, task), reactive_(options), navigation_(robot_) {
    try {
      const files::ScratchFolder scratch;
      navigation_.loadConfigFile(configurationFor(options, task));
      navigation_.params_abstract_ptg_navigator.ptg_cache_files_directory = scratch.path();
      navigation_.initialize();
    } catch (const core::InputError&) {
      throw;
    } catch (const std::exception& error) {
      // MRPT's errors go on with a back trace.
      const std::string text = error.what();
      throw core::InputError(options.config +
                             ": MRPT's reactive navigation refuses it: " + text.substr(0, text.find('\n')));
    }
  }

 private:
  GoalStep plan(const lidar::Scan& /*scan*/, const core::Pose2& T_odom_robot) override {
    now_s_ += task_.period_s;
    GoalStep step = decide(T_odom_robot);
    robot_.drive(step.command);
    const bool stands = std::abs(step.command.speed_mps) < kStanding_mps;
    standing_s_ = stands ? standing_s_ + task_.period_s : 0;
    return step;
  }

  GoalStep decide(const core::Pose2& T_odom_robot) {
    if (comesNoNearer(T_odom_robot))
      return {{},
              GoalStatus::kGaveUp,
              "gave up",
              "no nearer to the goal for " + files::formatNumber(reactive_.give_up_s) + " s"};
    const double direction_rad = goalDirection(T_odom_robot), distance_m = goalDistance(T_odom_robot);
    if (turnsInPlace(T_odom_robot))
      return {surroundings_.turn(core::angleDifference(*heading_odom_rad_, T_odom_robot.phi)),
              GoalStatus::kMoving, "turn in place", "MRPT's paths do not turn in place"};
    if (distance_m < kApproach_m && freeToGoal(T_odom_robot) >= distance_m)
      return {surroundings_.towards(direction_rad, distance_m), GoalStatus::kMoving, "approach",
              "the way to the goal is free"};
    return react(T_odom_robot);
  }

  /// One step of MRPT's navigation.
  GoalStep react(const core::Pose2& T_odom_robot) {
    const SimulatedClock clock(now_s_);
    robot_.sense(surroundings_.points(), T_odom_robot, now_s_);
    aim(T_odom_robot);
    navigation_.navigationStep();
    if (navigation_.getCurrentState() == mrpt::nav::CAbstractNavigator::NAV_ERROR)
      return {{}, GoalStatus::kGaveUp, "gave up", "MRPT: " + navigation_.getErrorReason().error_msg};
    return {surroundings_.guarded(robot_.wanted(task_.period_s)), GoalStatus::kMoving, "reactive",
            "CReactiveNavigationSystem drives"};
  }

  bool comesNoNearer(const core::Pose2& T_odom_robot) {
    const double distance_m = goalDistance(T_odom_robot);
    if (distance_m < nearest_m_) nearest_m_ = distance_m, nearest_time_s_ = now_s_;
    return now_s_ - nearest_time_s_ >= reactive_.give_up_s;
  }

  /// Towards the goal when it lies far aside and the first metre of the way there is free; towards the free
  /// direction nearest to it when MRPT has found no path for a second.
  bool turnsInPlace(const core::Pose2& T_odom_robot) {
    const double aside_rad = goalDirection(T_odom_robot);
    const double free_ahead_m = std::min(goalDistance(T_odom_robot), kFreeAhead_m);
    if (!heading_odom_rad_ && standing_s_ >= kStuck_s)
      heading_odom_rad_ = T_odom_robot.phi + freeDirection(aside_rad, free_ahead_m);
    else if (!heading_odom_rad_ && std::abs(aside_rad) > kFarAside_rad &&
             freeToGoal(T_odom_robot) >= free_ahead_m)
      heading_odom_rad_ = T_odom_robot.phi + aside_rad;
    if (!heading_odom_rad_) return false;
    if (std::abs(core::angleDifference(*heading_odom_rad_, T_odom_robot.phi)) > kFacing_rad) return true;
    heading_odom_rad_.reset();
    standing_s_ = 0;
    return false;
  }

  /// Robot frame. Not where it faces now, for there MRPT saw no path; straight back when nothing is free.
  double freeDirection(double wanted_rad, double free_ahead_m) const {
    for (int i = 0; i <= 18; ++i)
      for (const int side : {1, -1}) {
        const double direction_rad = core::wrapToPi(wanted_rad + side * core::degToRad(10.0 * i));
        if (std::abs(direction_rad) < 2 * kFacing_rad) continue;
        if (surroundings_.way(direction_rad, surroundings_.followRadius()).free_m >= free_ahead_m)
          return direction_rad;
      }
    return core::kPi;
  }

  /// MRPT's paths end at look_ahead_m: its target is the goal or a point on the straight line there, within
  /// their reach. A new target makes MRPT think anew, so it moves on in strides.
  void aim(const core::Pose2& T_odom_robot) {
    const double distance_m = goalDistance(T_odom_robot);
    const double share = std::min(1.0, kReachShare * reactive_.look_ahead_m / distance_m);
    const core::Point2 p_odom_aim = {T_odom_robot.x + share * (task_.p_odom_goal.x - T_odom_robot.x),
                                     T_odom_robot.y + share * (task_.p_odom_goal.y - T_odom_robot.y)};
    const double stride_m = share < 1 ? kStride_m : 1e-6;
    if (aimed_ && core::distance(p_odom_aim, p_odom_aim_) <= stride_m) return;
    aimed_ = true;
    p_odom_aim_ = p_odom_aim;
    mrpt::nav::CAbstractPTGBasedReactive::TNavigationParamsPTG wish;
    wish.target.target_coords = {p_odom_aim.x, p_odom_aim.y, 0};
    // Nearer than our tolerance, which is what ends the drive.
    wish.target.targetAllowedDistance = static_cast<float>(0.5 * options_.goal_tolerance_m);
    navigation_.navigate(&wish);
  }

  const ReactiveOptions reactive_;
  RobotForMrpt robot_;
  Navigation navigation_;
  double now_s_ = kEpoch_s;
  double nearest_m_ = std::numeric_limits<double>::infinity(), nearest_time_s_ = kEpoch_s;
  double standing_s_ = 0;
  std::optional<double> heading_odom_rad_;  ///< that it turns to
  bool aimed_ = false;
  core::Point2 p_odom_aim_;
};

}  // namespace

bool reactiveNavigationAvailable() {
  return true;
}

std::unique_ptr<goals::GoalNavigator> makeReactiveNavigator(const ReactiveOptions& options,
                                                            const goals::NavigateOptions& navigate_options,
                                                            const goals::GoalTask& task) {
  const bool finite = std::isfinite(task.p_odom_goal.x) && std::isfinite(task.p_odom_goal.y);
  if (!finite || !(task.period_s > 0))
    throw core::ContractError("makeReactiveNavigator: expected a finite goal and a positive period");
  return std::make_unique<ReactiveNavigator>(options, navigate_options, task);
}

}  // namespace slam::mrptnav
