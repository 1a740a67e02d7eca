#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

#include "libslam/core/error.h"
#include "libslam/navigate/strategy.h"
#include "libslam/navigate/view.h"

namespace slam::navigate {
namespace {

constexpr double kNewPlace_m = 0.5;  // nearer to the last place it counts as being stuck
constexpr double kShortestEscape_m = 0.2;
constexpr double kShortestDrive_m = 0.01;   // less than this is not worth a period
constexpr double kSmallestTurn_rad = 1e-3;  // below what any odometry notices
constexpr double kEscapeStep_rad = core::kPi / 36;
constexpr int kTransitionsPerPeriod = 8;

enum class Phase { kDeciding, kTurning, kDriving, kBacking };

}  // namespace

struct Driver::State {
  std::unique_ptr<Strategy> strategy;
  StrategyOptions options;
  robot::RobotOptions robot;
  double period_s;
  core::RandomStream random;

  Phase phase = Phase::kDeciding;
  Decision decision = {};
  bool escaping = false;  ///< the decision is a random free direction: only the disc has to fit
  int failures = 0;       ///< decisions in a row that led to no new place
  std::optional<core::Pose2> T_odom_place = std::nullopt;  ///< the last new place
  double target_heading_rad = 0;
  core::Pose2 T_odom_begin = {};  ///< where the present drive or backing began

  std::optional<robot::Command> advance(const robot::Scan& scan, const core::Pose2& T_odom_robot);
  void decide(const robot::Scan& scan, const core::Pose2& T_odom_robot);
  Decision escape(const robot::Scan& scan);
  std::optional<robot::Command> turn(const core::Pose2& T_odom_robot);
  std::optional<robot::Command> drive(const robot::Scan& scan, const core::Pose2& T_odom_robot);
  std::optional<robot::Command> back(const robot::Scan& scan, const core::Pose2& T_odom_robot);
  void endDrive(const core::Pose2& T_odom_robot);

  /// How far the disc may go straight along direction_rad by this scan.
  double reach(const robot::Scan& scan, double direction_rad) const {
    // The nearest of many noisy readings already lies some standard deviations before the wall.
    const double margin_m = 0.02 + scan.range_sigma_m;
    return freeTravel(robot::scanPoints(scan), direction_rad, robot::circumscribedRadius(robot) + margin_m);
  }
  robot::Command straight(double distance_m) const { return {distance_m / period_s, 0, period_s}; }
  robot::Command stand() const { return {0, 0, period_s}; }
};

std::optional<robot::Command> Driver::State::advance(const robot::Scan& scan,
                                                     const core::Pose2& T_odom_robot) {
  switch (phase) {
    case Phase::kDeciding:
      decide(scan, T_odom_robot);
      return std::nullopt;
    case Phase::kTurning:
      return turn(T_odom_robot);
    case Phase::kDriving:
      return drive(scan, T_odom_robot);
    case Phase::kBacking:
      return back(scan, T_odom_robot);
  }
  return std::nullopt;
}

void Driver::State::decide(const robot::Scan& scan, const core::Pose2& T_odom_robot) {
  if (!T_odom_place) T_odom_place = T_odom_robot;
  escaping = failures >= options.patience;
  decision = escaping ? escape(scan) : strategy->decide(scan, T_odom_robot);
  target_heading_rad = core::wrapToPi(T_odom_robot.phi + decision.turn_rad);
  T_odom_begin = T_odom_robot;
  phase = Phase::kTurning;
}

Decision Driver::State::escape(const robot::Scan& scan) {
  struct Way {
    double angle_rad, reach_m;
  };
  std::vector<Way> ways;
  double last_rad = -core::kPi;
  for (const auto& beam : seenBeams(scan)) {
    if (beam.angle_rad - last_rad < kEscapeStep_rad) continue;
    last_rad = beam.angle_rad;
    const double reach_m = std::min(beam.range_m, reach(scan, beam.angle_rad));
    if (reach_m >= kShortestEscape_m) ways.push_back({beam.angle_rad, reach_m});
  }
  Decision chosen;
  char reason[80];
  if (ways.empty()) {
    // Nothing that is seen is free: look elsewhere, at least a quarter turn away.
    chosen.turn_rad = (random.chance(0.5) ? 1 : -1) * random.uniform(core::kPi / 2, core::kPi);
    std::snprintf(reason, sizeof reason, "stuck: look around by %.0f deg", core::radToDeg(chosen.turn_rad));
  } else {
    const Way& way = ways[random.below(ways.size())];
    chosen.turn_rad = core::wrapToPi(way.angle_rad);
    chosen.distance_m = std::max(kShortestEscape_m, way.reach_m * random.uniform(0.5, 1.0));
    chosen.score = way.reach_m;
    std::snprintf(reason, sizeof reason, "stuck: random free direction at %.0f deg",
                  core::radToDeg(chosen.turn_rad));
  }
  chosen.reason = reason;
  return chosen;
}

std::optional<robot::Command> Driver::State::turn(const core::Pose2& T_odom_robot) {
  const double rest_rad = core::angleDifference(target_heading_rad, T_odom_robot.phi);
  const double most_rad = robot.max_turn_rate_radps * period_s;
  // The last part of a turn is not corrected again: odometry noise would keep it turning.
  if (std::abs(rest_rad) <= most_rad) phase = Phase::kDriving;
  if (std::abs(rest_rad) < kSmallestTurn_rad) return std::nullopt;
  return robot::Command{0, std::clamp(rest_rad, -most_rad, most_rad) / period_s, period_s};
}

std::optional<robot::Command> Driver::State::drive(const robot::Scan& scan, const core::Pose2& T_odom_robot) {
  const double driven_m = core::distance(T_odom_begin, T_odom_robot);
  const double rest_m = decision.distance_m - driven_m;
  if (rest_m < kShortestDrive_m) {
    endDrive(T_odom_robot);
    return std::nullopt;
  }
  const FreeWays ways = canMove(scan, options.stop_clearance_m);
  const bool front_free = ways == FreeWays::kBoth || ways == FreeWays::kFrontOnly;
  const double step_m = std::min({rest_m, robot.max_speed_mps * period_s, reach(scan, 0)});
  if ((!front_free && !escaping) || step_m < kShortestDrive_m) {
    endDrive(T_odom_robot);
    // Stopped before it moved at all: deciding again from here would decide the same.
    if (driven_m < kShortestDrive_m) phase = Phase::kBacking;
    return std::nullopt;
  }
  return straight(step_m);
}

std::optional<robot::Command> Driver::State::back(const robot::Scan& scan, const core::Pose2& T_odom_robot) {
  const double rest_m = options.back_off_m - core::distance(T_odom_begin, T_odom_robot);
  const FreeWays ways = canMove(scan, options.stop_clearance_m);
  const bool rear_free = ways == FreeWays::kBoth || ways == FreeWays::kRearOnly;
  const double step_m = std::min({rest_m, robot.max_speed_mps * period_s, reach(scan, core::kPi)});
  if (!rear_free || step_m < kShortestDrive_m) {
    phase = Phase::kDeciding;
    return std::nullopt;
  }
  return straight(-step_m);
}

void Driver::State::endDrive(const core::Pose2& T_odom_robot) {
  const bool only_turned = decision.distance_m == 0 && std::abs(decision.turn_rad) > kSmallestTurn_rad;
  // Farther than backing off leads, or backing off and coming again would count as progress for ever.
  const double new_place_m = std::max(kNewPlace_m, 2 * options.back_off_m);
  const bool new_place = core::distance(*T_odom_place, T_odom_robot) >= new_place_m;
  if (new_place) T_odom_place = T_odom_robot;
  failures = only_turned || new_place ? 0 : failures + 1;
  phase = Phase::kDeciding;
}

Driver::Driver(std::unique_ptr<Strategy> strategy, const StrategyOptions& options,
               const robot::RobotOptions& robot, double period_s, core::RandomStream random) {
  if (!strategy) throw core::ContractError("Driver: expected a strategy");
  if (!(period_s > 0) || !std::isfinite(period_s))
    throw core::ContractError("Driver: expected a positive period");
  state_ = std::make_unique<State>(State{std::move(strategy), options, robot, period_s, random});
}

Driver::~Driver() = default;

robot::Command Driver::next(const robot::Scan& scan, const core::Pose2& T_odom_robot, bool collided) {
  State& state = *state_;
  if (collided) {
    // What was hit is not in the scans: leave on the side that was just driven.
    ++state.failures;
    state.T_odom_begin = T_odom_robot;
    state.phase = state.phase == Phase::kDriving ? Phase::kBacking : Phase::kDeciding;
  }
  for (int i = 0; i < kTransitionsPerPeriod && !finished(); ++i)
    if (const auto command = state.advance(scan, T_odom_robot)) return *command;
  return state.stand();
}

bool Driver::wantsMap() const {
  return state_->strategy->needsMap() && !finished() && state_->phase == Phase::kDeciding;
}

void Driver::setMap(const gridmap::OccupancyRaster& map) {
  state_->strategy->seeMap(map);
}

bool Driver::finished() const {
  return state_->decision.finished;
}

const Decision& Driver::currentDecision() const {
  return state_->decision;
}

}  // namespace slam::navigate
