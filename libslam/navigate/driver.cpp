#include "libslam/navigate/driver.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/goals/goal_navigator.h"
#include "libslam/goals/look_first.h"
#include "libslam/navigate/bumps.h"
#include "libslam/navigate/escape.h"
#include "libslam/paths/path_follower.h"
#include "libslam/safety/free_ways.h"
#include "libslam/safety/obstacle_memory.h"
#include "libslam/safety/safe_motion.h"
#include "libslam/safety/view.h"
#include "libslam/strategies/strategy.h"

namespace slam::navigate {
namespace {

constexpr double kNewPlace_m = 0.5;         // nearer to the last place it counts as being stuck
constexpr double kShortestDrive_m = 0.01;   // less than this is not worth a period
constexpr double kSmallestTurn_rad = 1e-3;  // below what any odometry notices
constexpr int kTransitionsPerPeriod = 8;

constexpr double kRayPatience = 4;  // times the straight drive, for the ways round what is in the way
constexpr double kRayTolerance_m = 0.1;
constexpr double kNews_m2 = 0.25;  // less new area than this may be the map's noise

enum class Phase { kDeciding, kTurning, kDriving, kBacking, kFollowing, kNavigating, kWaiting };

}  // namespace

struct Driver::State {
  std::unique_ptr<strategies::Strategy> strategy;
  strategies::StrategyOptions options;
  robot::RobotOptions robot;
  double period_s;
  core::RandomStream random;

  Phase phase = Phase::kDeciding;
  choices::Decision decision = {};
  bool escaping = false;  ///< the decision is a random free direction: only the disc has to fit
  int failures = 0;       ///< decisions in a row that led to no new place
  std::optional<core::Pose2> T_map_place = std::nullopt;  ///< the last new place
  double target_heading_rad = 0;
  core::Pose2 T_map_begin = {};  ///< where the present drive or backing began

  paths::PathFollower follower = {};
  bool had_map = false;
  bool map_is_new = false;    ///< given since the last command
  int periods_unchecked = 0;  ///< since the path was last checked by a map
  double known_m2 = 0;        ///< area of the newest map
  double most_known_m2 = 0;   ///< when there was last any news
  int barren = 0;             ///< decisions in a row without news
  double waited_s = 0;        ///< of the decision at hand

  std::unique_ptr<safety::ObstacleMemory> memory = nullptr;
  Bumps bumps = {};
  std::vector<core::Point2> remembered = {};  ///< robot frame
  std::optional<goals::LookFirst> look_first = std::nullopt;
  std::unique_ptr<goals::GoalNavigator> navigator = nullptr;
  robot::Command told = {};
  bool collided = false;   ///< by the last command
  bool w_follows = false;  ///< stop_clearance_m is that of stopClearance()

  std::optional<robot::Command> advance(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  void decide(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::optional<robot::Command> turn(const core::Pose2& T_map_robot);
  std::optional<robot::Command> drive(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::optional<robot::Command> back(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::optional<robot::Command> follow(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::optional<robot::Command> navigate(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  void sense(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  void startNavigator(const core::Pose2& T_map_robot);
  void endDrive(const core::Pose2& T_map_robot);
  std::optional<robot::Command> look(const robot::Command& command);
  bool isBarren();
  bool checkIsDue() const { return periods_unchecked * period_s >= options.recheck_s; }

  double reach(const lidar::Scan& scan, double direction_rad) const {
    return safety::discReach(scan, direction_rad, robot, remembered);
  }
  /// By the rule that the strategy drives by.
  bool frontIsFree(const lidar::Scan& scan) const {
    if (escaping) return true;
    if (strategy->drivesByDisc()) return safety::seesAhead(scan);
    const safety::FreeWays ways = safety::canMove(scan, options.stop_clearance_m, remembered);
    return ways == safety::FreeWays::kBoth || ways == safety::FreeWays::kFrontOnly;
  }
  bool rearIsFree(const lidar::Scan& scan) const {
    const double body_m = robot::circumscribedRadius(robot);
    const double clearance_m =
        strategy->drivesByDisc() ? std::min(body_m, options.stop_clearance_m) : options.stop_clearance_m;
    const safety::FreeWays ways = safety::canMove(scan, clearance_m, remembered);
    return ways == safety::FreeWays::kBoth || ways == safety::FreeWays::kRearOnly;
  }
  robot::Command straight(double distance_m) const { return {distance_m / period_s, 0, period_s}; }
  robot::Command stand() const { return {0, 0, period_s}; }
};

std::optional<robot::Command> Driver::State::advance(const lidar::Scan& scan,
                                                     const core::Pose2& T_map_robot) {
  switch (phase) {
    case Phase::kDeciding:
      // Not by an old map: it does not show yet what was just driven up to.
      if (strategy->needsMap() && !map_is_new && had_map) return stand();
      decide(scan, T_map_robot);
      return std::nullopt;
    case Phase::kTurning:
      return turn(T_map_robot);
    case Phase::kDriving:
      return drive(scan, T_map_robot);
    case Phase::kBacking:
      return back(scan, T_map_robot);
    case Phase::kFollowing:
      return follow(scan, T_map_robot);
    case Phase::kNavigating:
      return navigate(scan, T_map_robot);
    case Phase::kWaiting:
      waited_s += period_s;
      if (waited_s > decision.wait_s) phase = Phase::kDeciding;
      return stand();
  }
  return std::nullopt;
}

/// Counts the decisions between which the map did not grow.
bool Driver::State::isBarren() {
  if (known_m2 >= most_known_m2 + kNews_m2) {
    most_known_m2 = known_m2;
    barren = failures = 0;
  }
  return ++barren > options.give_up_after;
}

void Driver::State::decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  if (!T_map_place) T_map_place = T_map_robot;
  if (strategy->needsMap() && isBarren()) {
    const std::string last = decision.reason;
    decision = {};
    decision.finished = true;
    decision.reason = "stuck: " + std::to_string(options.give_up_after) +
                      " decisions in a row showed nothing new; the last: " + last;
    return;
  }
  escaping = failures >= options.patience;
  decision = escaping ? escapeFrom(
                            scan, [&](double angle_rad) { return reach(scan, angle_rad); }, random)
                      : strategy->decide(scan, T_map_robot);
  if (decision.wait_s > 0) {
    waited_s = failures = barren = 0;
    phase = Phase::kWaiting;
    return;
  }
  if (!decision.path.empty()) {
    follower = paths::PathFollower(decision.path, decision.look_at);
    periods_unchecked = 0;
    phase = Phase::kFollowing;
    return;
  }
  target_heading_rad = core::wrapToPi(T_map_robot.phi + decision.turn_rad);
  T_map_begin = T_map_robot;
  phase = Phase::kTurning;
  if (!escaping && decision.ray_m > 0 && options.ray_navigator != "none") startNavigator(T_map_robot);
}

/// The newest scan, and what it shows besides itself: the obstacles that are remembered, and the w that
/// follows from it.
void Driver::State::sense(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  strategy->seeCommand(std::exchange(told, {}));
  strategy->seeScan(scan, T_map_robot);
  memory->update(scan, T_map_robot);
  remembered = memory->points();
  const core::Pose2 T_robot_map = core::inverse(T_map_robot);
  bumps.pass(period_s);
  for (const auto* unseen : {&strategy->people(), &bumps.places()})
    for (const auto& p_map : *unseen) remembered.push_back(T_robot_map * p_map);
  if (look_first) {
    look_first->update(scan, T_map_robot);
    for (const auto& p_robot : look_first->hidden()) remembered.push_back(p_robot);
  }
  if (!w_follows) return;
  options.stop_clearance_m = safety::stopClearance(robot, period_s, scan.range_sigma_m);
  strategy->setStopClearance(options.stop_clearance_m);
}

/// The look that a command needs first; a drive is then taken up again by a turn back to its heading.
std::optional<robot::Command> Driver::State::look(const robot::Command& command) {
  if (!look_first || phase == Phase::kNavigating) return std::nullopt;  // a navigator looks for itself
  const auto instead = look_first->instead(command);
  if (instead && phase == Phase::kDriving) phase = Phase::kTurning;
  return instead;
}

void Driver::State::startNavigator(const core::Pose2& T_map_robot) {
  const double distance_m = std::min(decision.distance_m, decision.ray_m - options.stop_clearance_m);
  if (distance_m <= kRayTolerance_m) return;
  goals::NavigateOptions ways;
  ways.goal_tolerance_m = kRayTolerance_m;
  ways.memory = options.memory == "none" ? ways.memory : options.memory;
  ways.obstacles = options.obstacles;
  ways.unseen = options.unseen;
  ways.time_limit_s =
      kRayPatience * (core::kPi / robot.max_turn_rate_radps + distance_m / robot.max_speed_mps);
  const core::Point2 p_robot_end = core::polar(distance_m, decision.turn_rad);
  navigator =
      goals::makeGoalNavigator(options.ray_navigator, ways, {T_map_robot * p_robot_end, robot, period_s});
  phase = Phase::kNavigating;
}

std::optional<robot::Command> Driver::State::navigate(const lidar::Scan& scan,
                                                      const core::Pose2& T_map_robot) {
  const goals::GoalStep step = navigator->next(scan, T_map_robot, collided);
  if (step.status == goals::GoalStatus::kMoving) return step.command;
  navigator.reset();
  const bool moved = core::distance(T_map_begin, T_map_robot) >= kShortestDrive_m;
  endDrive(T_map_robot);
  if (!moved) phase = Phase::kBacking;
  return std::nullopt;
}

std::optional<robot::Command> Driver::State::turn(const core::Pose2& T_map_robot) {
  const double rest_rad = core::angleDifference(target_heading_rad, T_map_robot.phi);
  const double most_rad = robot.max_turn_rate_radps * period_s;
  // The last part of a turn is not corrected again: odometry noise would keep it turning.
  if (std::abs(rest_rad) <= most_rad) phase = Phase::kDriving;
  if (std::abs(rest_rad) < kSmallestTurn_rad) return std::nullopt;
  return robot::Command{0, std::clamp(rest_rad, -most_rad, most_rad) / period_s, period_s};
}

std::optional<robot::Command> Driver::State::drive(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  const double driven_m = core::distance(T_map_begin, T_map_robot);
  const double rest_m = decision.distance_m - driven_m;
  if (rest_m < kShortestDrive_m) {
    endDrive(T_map_robot);
    return std::nullopt;
  }
  const double step_m = std::min({rest_m, robot.max_speed_mps * period_s, reach(scan, 0)});
  if (!frontIsFree(scan) || step_m < kShortestDrive_m) {
    endDrive(T_map_robot);
    // Stopped before it moved at all: deciding again from here would decide the same.
    if (driven_m < kShortestDrive_m) phase = Phase::kBacking;
    return std::nullopt;
  }
  return straight(step_m);
}

std::optional<robot::Command> Driver::State::back(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  const double rest_m = options.back_off_m - core::distance(T_map_begin, T_map_robot);
  const double step_m = std::min({rest_m, robot.max_speed_mps * period_s, reach(scan, core::kPi)});
  const robot::Command command = straight(-step_m);
  if (!rearIsFree(scan) || step_m < kShortestDrive_m ||
      (look_first && look_first->leadsOverUnseen(command))) {
    phase = Phase::kDeciding;
    return std::nullopt;
  }
  return command;
}

std::optional<robot::Command> Driver::State::follow(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  if (map_is_new) {
    periods_unchecked = 0;
    if (!strategy->isStillGood(decision, T_map_robot, follower.waypoint())) {
      phase = Phase::kDeciding;
      return std::nullopt;
    }
  }
  ++periods_unchecked;
  const auto step = follower.next(scan, T_map_robot, robot, options.slow_clearance_m, period_s, remembered);
  if (step.status == paths::PathFollower::Status::kFollowing) return step.command;
  const bool arrived = step.status == paths::PathFollower::Status::kArrived;
  strategy->tellOutcome(decision, arrived);
  if (arrived)
    failures = 0;
  else
    ++failures;
  T_map_begin = T_map_robot;
  phase = arrived ? Phase::kDeciding : Phase::kBacking;
  return std::nullopt;
}

void Driver::State::endDrive(const core::Pose2& T_map_robot) {
  const bool only_turned = decision.distance_m == 0 && std::abs(decision.turn_rad) > kSmallestTurn_rad;
  // Farther than backing off leads, or backing off and coming again would count as progress for ever.
  const double new_place_m = std::max(kNewPlace_m, 2 * options.back_off_m);
  const bool new_place = core::distance(*T_map_place, T_map_robot) >= new_place_m;
  if (new_place) T_map_place = T_map_robot;
  failures = only_turned || new_place ? 0 : failures + 1;
  phase = Phase::kDeciding;
}

Driver::Driver(std::unique_ptr<strategies::Strategy> strategy, const strategies::StrategyOptions& options,
               const robot::RobotOptions& robot, double period_s, core::RandomStream random) {
  if (!strategy) throw core::ContractError("Driver: expected a strategy");
  if (!(period_s > 0) || !std::isfinite(period_s))
    throw core::ContractError("Driver: expected a positive period");
  strategy->setRobot(robot);
  state_ = std::make_unique<State>(State{std::move(strategy), options, robot, period_s, random});
  state_->memory = safety::makeObstacleMemory(options.memory, options.obstacles);
  if (options.unseen == "looked_at") state_->look_first.emplace(robot, period_s, options.obstacles);
  state_->w_follows = options.stop_clearance_m == 0;
}

Driver::~Driver() = default;

robot::Command Driver::next(const lidar::Scan& scan, const core::Pose2& T_map_robot, bool collided) {
  State& state = *state_;
  state.sense(scan, T_map_robot);
  state.collided = collided;
  // A navigator feels for itself what was hit.
  if (collided && state.phase != Phase::kNavigating) {
    // What was hit is not in the scans: leave on the side that was just driven.
    const double radius_m = robot::circumscribedRadius(state.robot);
    ++state.failures;
    state.T_map_begin = T_map_robot;
    const bool ahead = state.phase == Phase::kDriving || state.phase == Phase::kFollowing;
    state.bumps.feel(T_map_robot * core::Point2{ahead ? radius_m : -radius_m, 0});
    if (state.phase == Phase::kFollowing) state.strategy->tellOutcome(state.decision, false);
    state.phase = ahead ? Phase::kBacking : Phase::kDeciding;
  }
  if (state.look_first && !finished())
    if (const auto turn = state.look_first->looking()) return state.told = *turn;
  robot::Command command = state.stand();
  for (int i = 0; i < kTransitionsPerPeriod && !finished(); ++i)
    if (const auto found = state.advance(scan, T_map_robot)) {
      command = *found;
      break;
    }
  if (const auto turn = state.look(command)) command = *turn;
  state.map_is_new = false;
  state.told = command;
  return command;
}

void Driver::watch(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  state_->sense(scan, T_map_robot);
}

void Driver::reconsider() {
  if (!finished()) state_->phase = Phase::kDeciding;
}

void Driver::setTeam(const std::vector<choices::Teammate>& team) {
  state_->strategy->seeTeam(team);
}

void Driver::setSpread(double spread_m) {
  state_->strategy->seeSpread(spread_m);
}

const strategies::Strategy& Driver::strategy() const {
  return *state_->strategy;
}

bool Driver::wantsMap() const {
  const State& state = *state_;
  if (!state.strategy->needsMap() || finished()) return false;
  return state.phase == Phase::kDeciding || (state.phase == Phase::kFollowing && state.checkIsDue());
}

void Driver::setMap(const gridmap::OccupancyRaster& map) {
  State& state = *state_;
  state.strategy->seeMap(map);
  const auto known = std::count_if(map.occupancy.begin(), map.occupancy.end(), [](float p) {
    return p < gridmap::kFreeBelow || p > gridmap::kOccupiedAbove;
  });
  state.known_m2 = static_cast<double>(known) * map.resolution_m * map.resolution_m;
  state.map_is_new = state.had_map = true;
}

bool Driver::finished() const {
  return state_->decision.finished;
}

const choices::Decision& Driver::currentDecision() const {
  return state_->decision;
}

}  // namespace slam::navigate
