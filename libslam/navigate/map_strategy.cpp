#include "libslam/navigate/map_strategy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "libslam/core/error.h"

namespace slam::navigate {
namespace {

constexpr double kViewpointSpacing_m = 1.0;
constexpr double kStandoffs_m[] = {1.0, 2.0, 4.0};
constexpr std::size_t kMostViewpoints = 30;  // at frontiers; keeps a decision short
constexpr double kSpent_m = 0.25;
constexpr int kLeaveAlone = 10;  // decisions
constexpr double kTarget_m = 3.0;
constexpr double kWorthGoing = 0.3;  // of the frontier cells still there

}  // namespace

void MapStrategy::seeMap(const gridmap::OccupancyRaster& map) {
  space_ = readFreeSpace(map);
}

bool MapStrategy::isSpent(const core::Point2& p_map) const {
  for (const auto& place : spent_)
    if (core::distance(place, p_map) < kSpent_m) return true;
  for (const auto& failure : failures_)
    if (failure.until > decisions_ && core::distance(failure.goal, p_map) < kSpent_m) return true;
  return false;
}

/// Of every frontier the cells that are in reach; counts the frontiers of which less than min_cells are.
std::vector<Frontier> MapStrategy::openFrontiers(const PathPlanner& planner, std::size_t min_cells) {
  out_of_reach_ = abandoned_ = 0;
  std::vector<Frontier> open;
  for (auto& frontier : findFrontiers(*space_, min_cells)) {
    Frontier kept;
    for (const std::size_t cell : frontier.cells)
      if (planner.accessOf(planner.nodeOf(cell))) kept.cells.push_back(cell);
    if (kept.cells.size() >= min_cells)
      open.push_back(std::move(kept));
    else
      ++out_of_reach_;
  }
  return open;
}

std::vector<Viewpoint> MapStrategy::viewpointsFor(const PathPlanner& planner,
                                                  const std::vector<Frontier>& frontiers) {
  std::vector<Viewpoint> viewpoints;
  for (std::size_t f = 0; f < frontiers.size(); ++f) {
    std::set<std::pair<double, PathPlanner::Node>> by_cost;
    for (const std::size_t cell : frontiers[f].cells) {
      const auto node = planner.accessOf(planner.nodeOf(cell));
      if (node) by_cost.emplace(planner.cost(*node), *node);
    }
    const std::size_t first = viewpoints.size();
    for (const auto& [cost_m, node] : by_cost) {
      const core::Point2 p = planner.pointOf(node);
      if (isSpent(p)) continue;
      const bool crowded = std::any_of(viewpoints.begin() + static_cast<std::ptrdiff_t>(first),
                                       viewpoints.end(), [&, &place = p](const Viewpoint& other) {
                                         return core::distance(other.p_map, place) < kViewpointSpacing_m;
                                       });
      if (crowded) continue;
      viewpoints.push_back({node, p, {}, 0, cost_m, f, true});
    }
  }
  const auto nearer = [](const Viewpoint& a, const Viewpoint& b) {
    return std::pair(a.cost_m, a.node) < std::pair(b.cost_m, b.node);
  };
  std::sort(viewpoints.begin(), viewpoints.end(), nearer);
  if (viewpoints.size() > kMostViewpoints) viewpoints.resize(kMostViewpoints);
  std::vector<Viewpoint> standoffs;
  for (auto& viewpoint : viewpoints) {
    viewpoint.way = planner.way(viewpoint.node);
    viewpoint.length_m = planner.length(viewpoint.way);
    if (!wantsStandoffs()) continue;
    for (const double back_m : kStandoffs_m) {
      const double share = 1 - back_m / viewpoint.length_m;
      if (!(share > 0.1)) break;
      const auto index = static_cast<std::size_t>(share * static_cast<double>(viewpoint.way.size() - 1));
      Viewpoint short_of = viewpoint;
      short_of.way.resize(index + 1);
      short_of.node = short_of.way.back();
      short_of.p_map = planner.pointOf(short_of.node);
      short_of.cost_m = planner.cost(short_of.node);
      short_of.length_m = planner.length(short_of.way);
      short_of.at_frontier = false;
      const bool crowded = std::any_of(standoffs.begin(), standoffs.end(), [&](const Viewpoint& other) {
        return core::distance(other.p_map, short_of.p_map) < kViewpointSpacing_m;
      });
      if (!crowded && !isSpent(short_of.p_map)) standoffs.push_back(std::move(short_of));
    }
  }
  viewpoints.insert(viewpoints.end(), standoffs.begin(), standoffs.end());
  std::sort(viewpoints.begin(), viewpoints.end(), nearer);
  return viewpoints;
}

Decision MapStrategy::finishedDecision() const {
  Decision decision;
  decision.finished = true;
  char reason[160];
  std::snprintf(reason, sizeof reason,
                "explored: no frontier of %.2f m left in reach; out of reach %zu, given up after a look %zu",
                options_.frontier_min_m, out_of_reach_, abandoned_);
  decision.reason = reason;
  return decision;
}

Decision MapStrategy::decide(const robot::Scan& scan, const core::Pose2& T_map_robot) {
  if (!space_)
    throw core::ContractError("strategy '" + options_.name +
                              "' works on the map: give it one first, seeMap()");
  ++decisions_;
  target_.clear();
  FreeSpace driving = *space_;
  closeGaps(driving);
  PlannerOptions planning;
  planning.radius_m = robot::circumscribedRadius(robot_) + options_.plan_margin_m;
  planning.comfort_m = std::max(planning.radius_m, options_.comfort_m);
  planning.look_m = options_.look_m;
  planning.optimistic = options_.optimistic;
  const PathPlanner planner(driving, planning, core::position(T_map_robot));
  if (!planner.hasStart()) {
    Decision decision;
    decision.reason = "no place near the robot admits it by the map";
    return decision;
  }
  const auto min_cells = static_cast<std::size_t>(
      std::max(1.0, std::ceil(options_.frontier_min_m / space_->resolution_m - 1e-9)));
  const auto frontiers = openFrontiers(planner, min_cells);
  auto viewpoints = viewpointsFor(planner, frontiers);
  if (viewpoints.empty() && std::any_of(failures_.begin(), failures_.end(),
                                        [&](const Failure& f) { return f.until > decisions_; })) {
    // What was only left alone for a while is tried once more; what failed twice stays given up.
    for (auto& failure : failures_)
      if (failure.until != std::numeric_limits<int>::max()) failure.until = decisions_;
    viewpoints = viewpointsFor(planner, frontiers);
  }
  std::optional<Choice> chosen_one;
  if (!viewpoints.empty())
    chosen_one = choose({*space_, planner, frontiers, viewpoints, lidarView(scan), T_map_robot});
  if (!chosen_one) {
    abandoned_ += frontiers.size();
    return finishedDecision();
  }
  const Choice& choice = *chosen_one;
  const Viewpoint& chosen = viewpoints[choice.viewpoint];
  Decision decision;
  decision.score = choice.score;
  decision.reason = choice.reason;
  decision.path = planner.shortened(chosen.way);
  decision.goal = decision.path.back();
  core::Point2 sum;
  for (const std::size_t cell : frontiers[chosen.frontier].cells) {
    const core::Point2 p = space_->centreOf(cell);
    if (core::distance(p, chosen.p_map) > kTarget_m && chosen.at_frontier) continue;
    target_.push_back(p);
    sum.x += p.x, sum.y += p.y;
  }
  if (choice.look_rad)
    decision.look_at = core::Point2{decision.goal.x + std::cos(*choice.look_rad),
                                    decision.goal.y + std::sin(*choice.look_rad)};
  else if (!target_.empty())
    decision.look_at = core::Point2{sum.x / static_cast<double>(target_.size()),
                                    sum.y / static_cast<double>(target_.size())};
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    if (i != choice.viewpoint) decision.alternatives.push_back(viewpoints[i].p_map);
  return decision;
}

bool MapStrategy::isStillGood(const Decision& decision, const core::Pose2& T_map_robot,
                              std::size_t next_waypoint) {
  if (!space_ || decision.path.empty()) return true;
  // By what is certainly in the way, without the planning margin: a path along its edge must not flicker.
  const double radius_m = robot::circumscribedRadius(robot_) - space_->resolution_m;
  const int reach = static_cast<int>(std::ceil(radius_m / space_->resolution_m));
  const auto blocked = [&](const core::Point2& p) {
    const int column = space_->columnOf(p.x), row = space_->rowOf(p.y);
    for (int dr = -reach; dr <= reach; ++dr)
      for (int dc = -reach; dc <= reach; ++dc)
        if (std::hypot(dc, dr) * space_->resolution_m <= radius_m &&
            space_->contains(column + dc, row + dr) &&
            space_->state[space_->index(column + dc, row + dr)] == kOccupiedCell)
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
  if (!options_.recheck || target_.empty()) return true;
  std::size_t left = 0;
  for (const auto& p : target_) {
    const int column = space_->columnOf(p.x), row = space_->rowOf(p.y);
    left += column > 0 && row > 0 && column + 1 < space_->columns && row + 1 < space_->rows &&
            isFrontierCell(*space_, space_->index(column, row));
  }
  return static_cast<double>(left) >= kWorthGoing * static_cast<double>(target_.size());
}

void MapStrategy::tellOutcome(const Decision& decision, bool reached) {
  if (decision.path.empty()) return;
  if (reached) {
    spent_.push_back(decision.goal);
    return;
  }
  const auto known = std::find_if(failures_.begin(), failures_.end(), [&](const Failure& f) {
    return core::distance(f.goal, decision.goal) < kSpent_m;
  });
  if (known == failures_.end())
    failures_.push_back({decision.goal, decisions_ + kLeaveAlone});
  else
    known->until = std::numeric_limits<int>::max();
}

}  // namespace slam::navigate
