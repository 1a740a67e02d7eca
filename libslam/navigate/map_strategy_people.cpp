#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/navigate/map_strategy.h"

/// What people make of a decision.
namespace slam::navigate {
namespace {

constexpr double kWait_s = 3;
constexpr int kMostWaits = 20;
/// Whom the robot waits for may wait for the robot: every so many waits it makes way.
constexpr int kWaitsToMakeWay = 4;
/// It goes at least so far, and farther where that gains as much room as its price.
constexpr double kAside_m = 1, kRoom_m = 1, kPrice = 0.05;

}  // namespace

/// Somebody may stand, or have stood, where the way goes on: before the robot ends it looks there again, and
/// waits for a while; it waits, too, where it was held up.
Decision MapStrategy::despitePeople(const paths::FreeSpace& looking, const robot::Scan& scan,
                                    const core::Pose2& T_map_robot) {
  const bool are_about = passers_.areAbout(), was_held_up = std::exchange(is_held_up_, false);
  if (are_about && was_held_up)
    if (auto waiting = wait(T_map_robot)) return *std::move(waiting);
  Decision decision = decideOn(looking, scan, T_map_robot);
  if (!are_about || !decision.finished || out_of_reach_ == 0) return decision;
  if (!passers_.areSmallThingsSuspected()) {
    passers_.suspectSmallThings();
    passers_.takeOutOf(*space_);
    decision = decideOn(withoutFalseFrontiers(), scan, T_map_robot);
    if (!decision.finished) return decision;
  }
  auto waiting = wait(T_map_robot);
  return waiting ? *std::move(waiting) : decision;
}

/// Nothing once that has been for nothing too often.
std::optional<Decision> MapStrategy::wait(const core::Pose2& T_map_robot) {
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
  Decision waiting;
  waiting.wait_s = kWait_s;
  waiting.reason = "waits: somebody may stand in the way";
  return waiting;
}

/// To where there is most room around the robot, of what is near.
std::optional<Decision> MapStrategy::makeWay(const core::Pose2& T_map_robot) const {
  const paths::FreeSpace driving = drivingSpace(true, T_map_robot);
  const paths::PathPlanner planner = plan(driving, true, T_map_robot);
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
  Decision aside;
  aside.path = planner.shortened(planner.way(*best));
  aside.goal = aside.path.back();
  aside.reason = "makes way for whom it waits for";
  return aside;
}

}  // namespace slam::navigate
