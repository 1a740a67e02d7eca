#include "libslam/mrptnav/reactive_navigator.h"

#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/core/Clock.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/nav/reactive/CReactiveNavigationSystem.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <system_error>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/navigate/surroundings.h"
#include "libslam/robot/mrpt_types.h"

namespace slam::mrptnav {
namespace {

using mrpt::kinematics::CVehicleVelCmd;
using mrpt::kinematics::CVehicleVelCmd_DiffDriven;
using navigate::GoalStatus;
using navigate::GoalStep;

constexpr double kBlind_s = 5.0;  // without a reading: as the other goal navigators

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

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "rasterslam-XXXXXX").string();
    if (!mkdtemp(pattern.data())) throw core::IoError(pattern + ": cannot be made");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
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

  double speed_mps() const { return speed_mps_; }
  double turnRate_radps() const { return turn_rate_radps_; }
  const std::string& trouble() const { return trouble_; }

  bool getCurrentPoseAndSpeeds(mrpt::math::TPose2D& pose, mrpt::math::TTwist2D& velocity,
                               mrpt::system::TTimeStamp& stamp, mrpt::math::TPose2D& odometry,
                               std::string& /*frame*/) override {
    pose = odometry = robot::toMrpt(T_odom_robot_);
    velocity = {driven_.speed_mps * std::cos(T_odom_robot_.phi),
                driven_.speed_mps * std::sin(T_odom_robot_.phi), driven_.turn_rate_radps};
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
  void sendWaySeemsBlockedEvent() override { trouble_ = "no nearer to the goal for too long"; }
  void sendApparentCollisionEvent() override {}
  void sendCannotGetCloserToBlockedTargetEvent() override { trouble_ = "the goal is blocked"; }

 private:
  mrpt::maps::CSimplePointsMap obstacles_;
  core::Pose2 T_odom_robot_;
  robot::Command driven_;
  double time_s_ = 0;
  double speed_mps_ = 0, turn_rate_radps_ = 0;
  std::string trouble_;
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

double E(const char* n, double d) { const char* t = std::getenv(n); return t ? std::atof(t) : d; }
std::string polygon(double radius_m, bool sines) {
  // Around the circle, not in it: the corners lie outside.
  const double corner_m = radius_m / std::cos(core::kPi / 16);
  std::string text;
  for (int i = 0; i < 16; ++i) {
    const double angle = (i + 0.5) * core::kPi / 8;
    text += core::formatNumber(corner_m * (sines ? std::sin(angle) : std::cos(angle))) + " ";
  }
  return text;
}

/// MRPT's file with our robot in it.
mrpt::config::CConfigFileMemory configurationFor(const ReactiveOptions& options,
                                                 const navigate::GoalTask& task, const std::string& scratch) {
  mrpt::config::CConfigFileMemory config(core::readTextFile(options.config));
  const std::string reactive = "CReactiveNavigationSystem", common = "CAbstractPTGBasedReactive";
  const double radius_m = robot::circumscribedRadius(task.robot) + E("CLR", options.clearance_m);
  const double turn_rate_degps = core::radToDeg(task.robot.max_turn_rate_radps);
  config.write(common, "robotMax_V_mps", task.robot.max_speed_mps);
  config.write(common, "robotMax_W_degps", turn_rate_degps);
  config.write(common, "ref_distance", E("LA", options.look_ahead_m));
  config.write(common, "ptg_cache_files_directory", scratch);
  config.write(reactive, "RobotModel_shape2D_xs", polygon(radius_m, false));
  config.write(reactive, "RobotModel_shape2D_ys", polygon(radius_m, true));
  config.write(reactive, "RobotModel_circular_shape_radius", radius_m);
  config.write("CAbstractNavigator", "alarm_seems_not_approaching_target_timeout", options.give_up_s);
  config.write("CHolonomicFullEval", "TOO_CLOSE_OBSTACLE", E("TC", 0.15));
  config.write(common, "secure_distance_start", E("SDS", 0.05));
  config.write(common, "secure_distance_end", E("SDE", 0.15));
  config.write(common, "enable_obstacle_filtering", E("FILT", 1) > 0);
  const int families = config.read_int(reactive, "PTG_COUNT", 0, true);
  for (int i = 0; i < families; ++i) {
    const std::string family = "PTG" + std::to_string(i) + "_";
    config.write(reactive, family + "refDistance", E("LA", options.look_ahead_m));
    config.write(reactive, family + "resolution", E("RES", 0.05));
    config.write(reactive, family + "v_max_mps", task.robot.max_speed_mps);
    config.write(reactive, family + "w_max_dps", turn_rate_degps);
  }
  return config;
}

class ReactiveNavigator : public navigate::GoalNavigator {
 public:
  ReactiveNavigator(const ReactiveOptions& options, const navigate::NavigateOptions& limits,
                    const navigate::GoalTask& task)
      : task_(task),
        tolerance_m_(limits.goal_tolerance_m),
        time_limit_s_(limits.time_limit_s),
        surroundings_(task.robot, limits.clearance_m, task.period_s),
        navigation_(robot_) {
    const ScratchFolder scratch;
    try {
      navigation_.loadConfigFile(configurationFor(options, task, scratch.path()));
      navigation_.params_abstract_ptg_navigator.ptg_cache_files_directory = scratch.path();
      navigation_.initialize();
    } catch (const core::InputError&) {
      throw;
    } catch (const std::exception& error) {
      throw core::InputError(options.config + ": MRPT's reactive navigation refuses it: " + error.what());
    }
  }

  GoalStep next(const robot::Scan& scan, const core::Pose2& T_odom_robot, bool collided) override {
    if (last_.status != GoalStatus::kMoving) return last_;
    look(scan, T_odom_robot, collided);
    if (last_.status == GoalStatus::kMoving) decide(scan, T_odom_robot);
    robot_.drive(last_.command);
    return last_;
  }

 private:
  void end(GoalStatus status, const std::string& reason) {
    last_ = {{0, 0, task_.period_s}, status, navigate::statusName(status), reason};
  }

  void look(const robot::Scan& scan, const core::Pose2& T_odom_robot, bool collided) {
    if (!core::isFinite(T_odom_robot)) return end(GoalStatus::kGaveUp, "the pose is not finite");
    const double distance_m = core::distance(core::position(T_odom_robot), task_.p_odom_goal);
    if (distance_m <= tolerance_m_) return end(GoalStatus::kReached, "within the tolerance");
    if (static_cast<double>(calls_++) * task_.period_s >= time_limit_s_)
      return end(GoalStatus::kGaveUp, "time limit");
    bool sees = false;
    for (const float range_m : scan.ranges_m) sees = sees || !std::isnan(range_m);
    blind_periods_ = sees ? 0 : blind_periods_ + 1;
    if (blind_periods_ * task_.period_s >= kBlind_s) return end(GoalStatus::kGaveUp, "no valid reading");
    if (collided) {
      surroundings_.feel(T_odom_robot, last_.command.speed_mps >= 0);
      robot_.drive({0, 0, task_.period_s});
    }
    surroundings_.update(scan, T_odom_robot);
  }

  void decide(const robot::Scan& scan, const core::Pose2& T_odom_robot) {
    using mrpt::nav::CAbstractNavigator;
    const SimulatedClock clock(scan.time_s);
    robot_.sense(surroundings_.points(), T_odom_robot, scan.time_s);
    if (!started_) start();
    navigation_.navigationStep();
    last_.state = "reactive";
    if (navigation_.getCurrentState() == CAbstractNavigator::NAV_ERROR)
      return end(GoalStatus::kGaveUp,
                 robot_.trouble().empty() ? navigation_.getErrorReason().error_msg : robot_.trouble());
    // MRPT is content a little before the goal is within the tolerance: its own check comes after its step.
    const robot::Command wanted = {robot_.speed_mps(), robot_.turnRate_radps(), task_.period_s};
    last_.command = surroundings_.guarded(wanted);
  }

  void start() {
    started_ = true;
    mrpt::nav::CAbstractPTGBasedReactive::TNavigationParamsPTG wish;
    wish.target.target_coords = {task_.p_odom_goal.x, task_.p_odom_goal.y, 0};
    // Nearer than the tolerance, so that it is ours that ends the drive.
    wish.target.targetAllowedDistance = static_cast<float>(0.5 * tolerance_m_);
    wish.target.targetDesiredRelSpeed = 0.05;
    navigation_.navigate(&wish);
  }

  navigate::GoalTask task_;
  double tolerance_m_, time_limit_s_;
  navigate::Surroundings surroundings_;
  RobotForMrpt robot_;
  Navigation navigation_;
  GoalStep last_;
  bool started_ = false;
  long calls_ = 0;
  int blind_periods_ = 0;
};

}  // namespace

bool reactiveNavigationAvailable() {
  return true;
}

std::unique_ptr<navigate::GoalNavigator> makeReactiveNavigator(
    const ReactiveOptions& options, const navigate::NavigateOptions& navigate_options,
    const navigate::GoalTask& task) {
  const bool finite = std::isfinite(task.p_odom_goal.x) && std::isfinite(task.p_odom_goal.y);
  if (!finite || !(task.period_s > 0))
    throw core::ContractError("makeReactiveNavigator: expected a finite goal and a positive period");
  return std::make_unique<ReactiveNavigator>(options, navigate_options, task);
}

}  // namespace slam::mrptnav
