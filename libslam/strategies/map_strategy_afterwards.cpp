#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/strategies/map_strategy.h"

/// What becomes of a decision: whether it still holds, and what people make of it.
namespace slam::strategies {
namespace {

constexpr double kWorthGoing = 0.3;  // of the frontier cells still there
constexpr double kWait_s = 3;
constexpr int kMostWaits = 20;
/// Whom the robot waits for may wait for the robot: every so many waits it makes way.
constexpr int kWaitsToMakeWay = 4;
/// It goes at least so far, and farther where that gains as much room as its price.
constexpr double kAside_m = 1, kRoom_m = 1, kPrice = 0.05;

}  // namespace

bool MapStrategy::isStillGood(const choices::Decision& decision, const core::Pose2& T_map_robot,
                              std::size_t next_waypoint) {
  if (!space_ || decision.path.empty()) return true;
  // By what is certainly in the way, without the planning margin: a path along its edge must not flicker.
  const double radius_m = robot::circumscribedRadius(robot_) - space_->resolution_m;
  const int reach = static_cast<int>(std::ceil(radius_m / space_->resolution_m));
  const auto blocked = [&](const core::Point2& p) {
    const int column = space_->columnOf(p.x), row = space_->rowOf(p.y);
    for (int dr = -reach; dr <= reach; ++dr)
      for (int dc = -reach; dc <= reach; ++dc)
        if (core::hypot(dc, dr) * space_->resolution_m <= radius_m &&
            space_->contains(column + dc, row + dr) &&
            space_->state[space_->index(column + dc, row + dr)] == paths::kOccupiedCell)
          return true;
    return false;
  };
  core::Point2 from = core::position(T_map_robot);
  for (std::size_t i = next_waypoint; i < decision.path.size(); from = decision.path[i++]) {
    const core::Point2& to = decision.path[i];
    const int steps = static_cast<int>(std::ceil(core::distance(from, to) / (2 * space_->resolution_m)));
    // Not where the robot stands: by the noisy map it may already touch something.
    for (int k = 1; k <= steps; ++k) {
      const double s = static_cast<double>(k) / steps;
      const core::Point2 p{from.x + s * (to.x - from.x), from.y + s * (to.y - from.y)};
      if (core::distance(p, core::position(T_map_robot)) > 0.2 && blocked(p)) return false;
    }
  }
  if (return_) return !certainty_.isDone(*return_);
  if (!options_.recheck || target_.empty()) return true;
  std::size_t left = 0;
  for (const auto& p : target_) {
    const int column = space_->columnOf(p.x), row = space_->rowOf(p.y);
    left += column > 0 && row > 0 && column + 1 < space_->columns && row + 1 < space_->rows &&
            paths::isFrontierCell(*space_, space_->index(column, row)) && !returns_.contains(placeOf(p));
  }
  return static_cast<double>(left) >= kWorthGoing * static_cast<double>(target_.size());
}

/// Somebody may stand, or have stood, where the way goes on: before the robot ends it looks there again, and
/// waits for a while; it waits, too, where it was held up.
choices::Decision MapStrategy::despitePeople(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  const bool are_about = passers_.areAbout(), was_held_up = std::exchange(is_held_up_, false);
  if (are_about && was_held_up)
    if (auto waiting = wait(T_map_robot)) return *std::move(waiting);
  choices::Decision decision = decideOn(withoutFalseFrontiers(), scan, T_map_robot);
  if (!are_about || !decision.finished || out_of_reach_ == 0) return decision;
  if (!passers_.areSmallThingsSuspected()) {
    passers_.suspectSmallThings();
    looking_.update(*space_, passers_.takeOutOf(*space_));
    decision = decideOn(withoutFalseFrontiers(), scan, T_map_robot);
    if (!decision.finished) return decision;
  }
  auto waiting = wait(T_map_robot);
  return waiting ? *std::move(waiting) : decision;
}

/// Nothing when no way back is worth it.
std::optional<choices::Decision> MapStrategy::goBack(const choices::Decision& next,
                                                     const core::Pose2& T_map_robot) {
  if (is_making_way_ || next.wait_s > 0 || (next.path.empty() && !next.finished) || !certainty_.mayPay())
    return std::nullopt;
  const paths::PathPlanner planner = plan(core::position(T_map_robot));
  const paths::FreeSpace& driving = ground_.space();
  std::optional<paths::PathPlanner::Node> goal;
  if (!next.path.empty()) {
    goal = planner.nodeOf(driving.index(driving.columnOf(next.goal.x), driving.rowOf(next.goal.y)));
    if (!planner.isReached(*goal)) return std::nullopt;
  }
  return_ = certainty_.best(driving, planner, goal);
  if (!return_) return std::nullopt;
  certainty_.begin(*return_);
  target_.clear();
  choices::Decision back;
  back.path = planner.shortened(planner.way(return_->node));
  back.goal = back.path.back();
  back.certainty_m = return_->gain_m;
  char reason[160];
  std::snprintf(reason, sizeof reason,
                "back for a loop: the pose, sure to %.3f m, was sure to %.3f m there; a detour of %.2f m",
                return_->spread_m + return_->gain_m, return_->spread_m, return_->detour_m);
  back.reason = reason;
  if (!next.path.empty()) back.alternatives.push_back(next.goal);
  return back;
}

/// Nothing once that has been for nothing too often.
std::optional<choices::Decision> MapStrategy::wait(const core::Pose2& T_map_robot) {
  if (space_->known >= known_at_wait_ + static_cast<std::size_t>(
                                            kLeastNews_m2 / (space_->resolution_m * space_->resolution_m)))
    waits_ = 0;
  known_at_wait_ = space_->known;
  if (waits_ >= kMostWaits) return std::nullopt;
  if (++waits_ % kWaitsToMakeWay == 0)
    if (auto aside = makeWay(T_map_robot)) {
      target_.clear();
      is_making_way_ = true;
      return aside;
    }
  choices::Decision waiting;
  waiting.wait_s = kWait_s;
  waiting.reason = "waits: somebody may stand in the way";
  return waiting;
}

/// To where there is most room around the robot, of what is near.
std::optional<choices::Decision> MapStrategy::makeWay(const core::Pose2& T_map_robot) const {
  const paths::FreeSpace driving = bareSpace(T_map_robot);
  const paths::PathPlanner planner(driving, planning(true), core::position(T_map_robot));
  const int reach_cells = std::clamp(static_cast<int>(kRoom_m / driving.resolution_m), 1, 120);
  const auto clearance =
      paths::squaredClearance(driving, paths::kOccupiedCell | paths::kUnknownCell, reach_cells);
  std::optional<paths::PathPlanner::Node> best;
  double best_gain = 0;
  for (paths::PathPlanner::Node node = 0; node < planner.nodeColumns() * planner.nodeRows(); ++node) {
    if (!planner.isReached(node)) continue;
    const core::Point2 p = planner.pointOf(node);
    if (core::distance(p, core::position(T_map_robot)) < kAside_m) continue;
    const auto cell = driving.index(driving.columnOf(p.x), driving.rowOf(p.y));
    const double gain = std::sqrt(clearance[cell]) * driving.resolution_m - kPrice * planner.cost(node);
    if (best && gain <= best_gain) continue;
    best = node;
    best_gain = gain;
  }
  if (!best) return std::nullopt;
  choices::Decision aside;
  aside.path = planner.shortened(planner.way(*best));
  aside.goal = aside.path.back();
  aside.reason = "makes way for whom it waits for";
  return aside;
}

}  // namespace slam::strategies
