#include "libslam/strategies/map_strategy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>
#include <utility>

#include "libslam/choices/team_share.h"
#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/rigid_motion2.h"

namespace slam::strategies {
namespace {

constexpr double kViewpointSpacing_m = 1.0;
constexpr double kStandoffs_m[] = {1.0, 2.0, 4.0};
constexpr std::size_t kViewpointsAtATime = 30;  // at frontiers; keeps a decision short
constexpr double kSpent_m = 0.25;
constexpr int kLeaveAlone = 10;  // decisions
constexpr double kTarget_m = 3.0;
constexpr double kLooked_m = 1.5;  // a look from as near as this should have shown what is behind a frontier
constexpr int kMostLooks = 2;
constexpr std::size_t kMostCellsForTwoPlans = 1500000;  // in one decision of less than 50 ms

/// Where the robot stands nothing else does, whatever the noisy map says.
void clearBody(paths::FreeSpace& space, const core::Point2& p_map, double radius_m) {
  const int column = space.columnOf(p_map.x), row = space.rowOf(p_map.y);
  const int reach = static_cast<int>(std::ceil(radius_m / space.resolution_m));
  for (int r = row - reach; r <= row + reach; ++r)
    for (int c = column - reach; c <= column + reach; ++c)
      if (c > 0 && r > 0 && c + 1 < space.columns && r + 1 < space.rows &&
          core::distance(space.centreOf(space.index(c, r)), p_map) < radius_m)
        space.state[space.index(c, r)] = paths::kFreeCell;
}

bool isNearer(const choices::Viewpoint& a, const choices::Viewpoint& b) {
  return std::pair(a.cost_m, a.node) < std::pair(b.cost_m, b.node);
}

}  // namespace

void MapStrategy::seeMap(const gridmap::OccupancyRaster& map) {
  paths::FreeSpace first;
  const auto read = paths::updateFreeSpace(map, space_ ? *space_ : first);
  if (!space_) space_ = std::move(first);
  looking_.update(*space_, paths::joined(read, passers_.takeOutOf(*space_)));
}

bool MapStrategy::isSpent(const core::Point2& p_map) const {
  for (const auto& place : spent_)
    if (core::areWithin(place, p_map, kSpent_m)) return true;
  for (const auto& failure : failures_)
    if (failure.until > decisions_ && core::areWithin(failure.goal, p_map, kSpent_m)) return true;
  return false;
}

core::PlaneCell MapStrategy::placeOf(const core::Point2& p_map) const {
  return core::planeCell(p_map, space_->resolution_m);
}

void MapStrategy::seeScan(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  certainty_.see(T_map_robot);
  if (!space_ || !core::isFinite(T_map_robot)) return;
  const double cell_m = space_->resolution_m;
  const core::RigidMotion2 T_map_scan(T_map_robot);
  for (const auto& p_robot : lidar::scanPoints(scan)) returns_.insertAround(T_map_scan * p_robot, cell_m);
  passers_.see(scan, T_map_robot, cell_m);
}

/// The map with an obstacle in every frontier cell at which the lidar has measured a return.
MapStrategy::Looking MapStrategy::withoutFalseFrontiers() {
  const auto isReturn = [&](std::size_t cell) { return returns_.contains(placeOf(space_->centreOf(cell))); };
  looking_.close(*space_, isReturn, closedGap_m());
  return {looking_.space(), looking_.frontierCells()};
}

void MapStrategy::annotate(gridmap::OccupancyRaster& map) const {
  if (!space_) return;
  const paths::FreeSpace space = paths::readFreeSpace(map);
  for (const std::size_t cell : paths::frontierCells(space)) {
    const core::Point2 p = space.centreOf(cell);
    const auto looks = looks_.find(placeOf(p));
    const bool is_given_up = looks != looks_.end() && looks->second >= kMostLooks;
    if (!is_given_up && !returns_.contains(placeOf(p))) continue;
    const auto column = static_cast<std::size_t>(map.columnOf(p.x)),
               row = static_cast<std::size_t>(map.rowOf(p.y));
    map.occupancy[row * static_cast<std::size_t>(map.columns) + column] = 1.0F;
  }
}

/// After a look: the frontier cells close by that it left standing.
void MapStrategy::judgeLook() {
  if (!looked_from_) return;
  const double news_m2 = (static_cast<double>(space_->known) - static_cast<double>(known_before_)) *
                         space_->resolution_m * space_->resolution_m;
  for (const auto& p : target_)
    if (core::distance(p, *looked_from_) < kLooked_m)
      looks_[placeOf(p)] += news_m2 < kLeastNews_m2 ? kMostLooks : 1;
  looked_from_.reset();
}

bool MapStrategy::isGivenUp(std::size_t cell) const {
  const auto looks = looks_.find(placeOf(space_->centreOf(cell)));
  return looks != looks_.end() && looks->second >= kMostLooks;
}

/// Of every frontier the cells that are in reach and not given up; counts the frontiers of which less than
/// min_cells are.
std::vector<paths::Frontier> MapStrategy::openFrontiers(const Looking& looking,
                                                        const paths::PathPlanner& planner,
                                                        std::size_t min_cells) {
  out_of_reach_ = abandoned_ = 0;
  std::vector<paths::Frontier> open;
  for (auto& frontier : paths::findFrontiers(looking.space, looking.frontier_cells, min_cells)) {
    paths::Frontier kept;
    std::size_t reached = 0;
    for (const std::size_t cell : frontier.cells) {
      if (!planner.accessOf(planner.nodeOf(cell))) continue;
      ++reached;
      if (!isGivenUp(cell)) kept.cells.push_back(cell);
    }
    if (kept.cells.size() >= min_cells)
      open.push_back(std::move(kept));
    else
      ++(reached >= min_cells ? abandoned_ : out_of_reach_);
  }
  return open;
}

/// By the map, through free cells only.
bool MapStrategy::seesStraight(const core::Point2& a, const core::Point2& b) const {
  const int steps = static_cast<int>(std::ceil(core::distance(a, b) / space_->resolution_m));
  for (int i = 1; i < steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    if (space_->at({a.x + s * (b.x - a.x), a.y + s * (b.y - a.y)}) != paths::kFreeCell) return false;
  }
  return true;
}

/// As near to the frontiers as the robot can, by cost; without the ways.
std::vector<choices::Viewpoint> MapStrategy::viewpointsFor(
    const paths::PathPlanner& planner, const std::vector<paths::Frontier>& frontiers) const {
  std::vector<choices::Viewpoint> viewpoints;
  for (std::size_t f = 0; f < frontiers.size(); ++f) {
    std::set<std::pair<double, paths::PathPlanner::Node>> by_cost;
    for (const std::size_t cell : frontiers[f].cells) {
      const auto node = planner.accessOf(planner.nodeOf(cell));
      if (node) by_cost.emplace(planner.cost(*node), *node);
    }
    const std::size_t first = sharedViewpoints() ? 0 : viewpoints.size();
    for (const auto& [cost_m, node] : by_cost) {
      const core::Point2 p = planner.pointOf(node);
      if (isSpent(p)) continue;
      const bool crowded = std::any_of(viewpoints.begin() + static_cast<std::ptrdiff_t>(first),
                                       viewpoints.end(), [&, &place = p](const choices::Viewpoint& other) {
                                         return core::areWithin(other.p_map, place, kViewpointSpacing_m) &&
                                                (!sharedViewpoints() || seesStraight(other.p_map, place));
                                       });
      if (crowded) continue;
      viewpoints.push_back({node, p, {}, 0, cost_m, f, true});
    }
  }
  std::sort(viewpoints.begin(), viewpoints.end(), isNearer);
  return viewpoints;
}

/// In a team: those of the viewpoints that are for this robot to go to.
void MapStrategy::keepMine(std::vector<choices::Viewpoint>& viewpoints) {
  std::vector<choices::Teammate> heard;
  std::vector<paths::PathPlanner> theirs;
  for (const auto& mate : team_) {
    if (!mate.is_heard) continue;
    heard.push_back(mate);
    theirs.push_back(plan(mate.p_map));
  }
  choices::keepWellPlaced(viewpoints, theirs, heard);
}

/// With their ways and, where wanted, with viewpoints short of them.
std::vector<choices::Viewpoint> MapStrategy::withWays(const paths::PathPlanner& planner,
                                                      std::vector<choices::Viewpoint> viewpoints) const {
  std::vector<choices::Viewpoint> standoffs;
  for (auto& viewpoint : viewpoints) {
    viewpoint.way = planner.way(viewpoint.node);
    viewpoint.length_m = planner.length(viewpoint.way);
    if (!wantsStandoffs()) continue;
    for (const double back_m : kStandoffs_m) {
      const double share = 1 - back_m / viewpoint.length_m;
      if (!(share > 0.1)) break;
      const auto index = static_cast<std::size_t>(share * static_cast<double>(viewpoint.way.size() - 1));
      choices::Viewpoint short_of = viewpoint;
      short_of.way.resize(index + 1);
      short_of.node = short_of.way.back();
      short_of.p_map = planner.pointOf(short_of.node);
      short_of.cost_m = planner.cost(short_of.node);
      short_of.length_m = planner.length(short_of.way);
      short_of.at_frontier = false;
      const bool crowded =
          std::any_of(standoffs.begin(), standoffs.end(), [&](const choices::Viewpoint& other) {
            return core::areWithin(other.p_map, short_of.p_map, kViewpointSpacing_m);
          });
      if (!crowded && !isSpent(short_of.p_map)) standoffs.push_back(std::move(short_of));
    }
  }
  viewpoints.insert(viewpoints.end(), standoffs.begin(), standoffs.end());
  std::sort(viewpoints.begin(), viewpoints.end(), isNearer);
  return viewpoints;
}

choices::Decision MapStrategy::finishedDecision() const {
  choices::Decision decision;
  decision.finished = true;
  char reason[160];
  std::snprintf(reason, sizeof reason,
                "explored: no frontier of %.2f m left in reach; out of reach %zu, given up after a look %zu",
                options_.frontier_min_m, out_of_reach_, abandoned_);
  decision.reason = reason;
  return decision;
}

paths::PlannerOptions MapStrategy::planning(bool bare) const {
  paths::PlannerOptions planning;
  planning.radius_m = robot::circumscribedRadius(robot_) + (bare ? 0 : options_.plan_margin_m);
  planning.comfort_m = std::max(planning.radius_m, options_.comfort_m);
  planning.look_m = options_.look_m;
  planning.optimistic = options_.optimistic;
  planning.tight_start = bare;
  return planning;
}

/// With the margin, by the newest map.
paths::PathPlanner MapStrategy::plan(const core::Point2& p_map_robot) {
  ground_.update(*space_, planning(false));
  return paths::PathPlanner(ground_, planning(false), p_map_robot);
}

/// The map to drive by for the disc alone.
paths::FreeSpace MapStrategy::bareSpace(const core::Pose2& T_map_robot) const {
  paths::FreeSpace driving = *space_;
  paths::closeGaps(driving);
  clearBody(driving, core::position(T_map_robot), robot::circumscribedRadius(robot_));
  return driving;
}

/// Nothing when there is nowhere to go by this plan.
std::optional<choices::Decision> MapStrategy::goOn(const paths::PathPlanner& planner, const Looking& looking,
                                                   const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  const auto min_cells = static_cast<std::size_t>(
      std::max(1.0, std::ceil(options_.frontier_min_m / space_->resolution_m - 1e-9)));
  const auto frontiers = openFrontiers(looking, planner, min_cells);
  auto viewpoints = viewpointsFor(planner, frontiers);
  if (viewpoints.empty() && std::any_of(failures_.begin(), failures_.end(),
                                        [&](const Failure& f) { return f.until > decisions_; })) {
    // What was only left alone for a while is tried once more; what failed twice stays given up.
    for (auto& failure : failures_)
      if (failure.until != std::numeric_limits<int>::max()) failure.until = decisions_;
    viewpoints = viewpointsFor(planner, frontiers);
  }
  if (!team_.empty()) keepMine(viewpoints);
  // The far ones only count when none of the near ones is worth going to.
  const std::size_t most = sharedViewpoints().value_or(kViewpointsAtATime);
  for (std::size_t first = 0; first < viewpoints.size(); first += most) {
    const auto begin = viewpoints.begin() + static_cast<std::ptrdiff_t>(first);
    const auto count = std::min(most, viewpoints.size() - first);
    const auto some = withWays(planner, {begin, begin + static_cast<std::ptrdiff_t>(count)});
    if (const auto choice = choose({looking.space, planner, looking.frontier_cells, frontiers, some,
                                    paths::lookShape(scan), T_map_robot}))
      return decisionFor(planner, frontiers, some, *choice);
  }
  abandoned_ += frontiers.size();
  return std::nullopt;
}

choices::Decision MapStrategy::decisionFor(const paths::PathPlanner& planner,
                                           const std::vector<paths::Frontier>& frontiers,
                                           const std::vector<choices::Viewpoint>& viewpoints,
                                           const Choice& choice) {
  const choices::Viewpoint& chosen = viewpoints[choice.viewpoint];
  choices::Decision decision;
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
    decision.look_at = core::Point2{decision.goal.x + core::cos(*choice.look_rad),
                                    decision.goal.y + core::sin(*choice.look_rad)};
  else if (!target_.empty())
    decision.look_at = core::Point2{sum.x / static_cast<double>(target_.size()),
                                    sum.y / static_cast<double>(target_.size())};
  for (std::size_t i = 0; i < viewpoints.size(); ++i)
    if (i != choice.viewpoint) decision.alternatives.push_back(viewpoints[i].p_map);
  return decision;
}

choices::Decision MapStrategy::decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  if (!space_)
    throw core::ContractError("strategy '" + options_.name +
                              "' works on the map: give it one first, seeMap()");
  ++decisions_;
  judgeLook();
  known_before_ = space_->known;
  return_.reset();
  choices::Decision next = decideNext(scan, T_map_robot);
  if (auto back = goBack(next, T_map_robot)) next = *std::move(back);
  next.spread_m = certainty_.spread_m().value_or(next.spread_m);
  return next;
}

choices::Decision MapStrategy::decideNext(const lidar::Scan& scan, const core::Pose2& T_map_robot) {
  is_making_way_ = false;
  if (team_.empty()) return despitePeople(scan, T_map_robot);
  const Looking looking = withoutFalseFrontiers();
  paths::FreeSpace left = looking.space;
  choices::closeTaken(left, team_, options_.unknown_path_m);
  const auto cells = paths::frontierCellsAmong(left, looking.frontier_cells);
  choices::Decision mine = decideOn({left, cells}, scan, T_map_robot);
  if (!mine.finished) return mine;
  choices::Decision late = decideOn(looking, scan, T_map_robot);
  if (!choices::isAnyOnItsWay(team_)) return late;
  if (late.finished) return choices::waitingForOthers("waits: others are at the last of it");
  return late.path.empty() ? late : choices::comingAfter(std::move(late), T_map_robot);
}

choices::Decision MapStrategy::decideOn(const Looking& looking, const lidar::Scan& scan,
                                        const core::Pose2& T_map_robot) {
  target_.clear();
  bool has_start = false;
  const bool only_bare = std::exchange(bare_next_, false);
  for (const bool bare : {false, true}) {
    if (only_bare && !bare) continue;
    const core::Point2 here = core::position(T_map_robot);
    const paths::FreeSpace disc = bare ? bareSpace(T_map_robot) : paths::FreeSpace();
    const paths::PathPlanner planner = bare ? paths::PathPlanner(disc, planning(true), here) : plan(here);
    if (!planner.hasStart()) continue;
    has_start = true;
    if (auto decision = goOn(planner, looking, scan, T_map_robot)) return *std::move(decision);
    if (out_of_reach_ + abandoned_ == 0) break;
    if (!bare && space_->state.size() > kMostCellsForTwoPlans) {
      bare_next_ = true;
      choices::Decision decision;
      decision.reason = "nothing left with the planning margin: next for the bare disc";
      return decision;
    }
  }
  if (has_start) return finishedDecision();
  choices::Decision decision;
  decision.reason = "no place near the robot admits it by the map";
  return decision;
}

void MapStrategy::tellOutcome(const choices::Decision& decision, bool reached) {
  if (decision.path.empty() || is_making_way_) return;
  if (decision.certainty_m > 0) {
    certainty_.end(decision.goal);
    return;
  }
  is_held_up_ = !reached;
  if (reached) {
    spent_.push_back(decision.goal);
    looked_from_ = decision.goal;
    return;
  }
  const auto known = std::find_if(failures_.begin(), failures_.end(), [&](const Failure& f) {
    return core::distance(f.goal, decision.goal) < kSpent_m;
  });
  if (known == failures_.end())
    failures_.push_back({decision.goal, decisions_ + kLeaveAlone});
  else
    // Whoever stood in the way may leave it.
    known->until = passers_.areAbout() ? decisions_ + kLeaveAlone : std::numeric_limits<int>::max();
}

}  // namespace slam::strategies
