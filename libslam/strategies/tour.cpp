#include "libslam/strategies/tour.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "libslam/choices/open_tour.h"
#include "libslam/core/elementary.h"
#include "libslam/paths/coarse_ways.h"

namespace slam::strategies {
namespace {

constexpr std::size_t kMostViewpoints = 40, kMostStops = 20;  // keep a decision short
constexpr std::size_t kMostBlocks = 10000;
constexpr double kDoor_m = 0.05;  // more than the robot's width that an opening to a room has
constexpr double kStop_m2 = 0.1;  // a stop of the tour adds this at least, unless none does
constexpr double kNews_m2 = 0.5;
constexpr double kUrgency = 0.4;
constexpr double kHysteresis_m = 2.0, kSameStop_m = 1.0;
constexpr double kWorthTheWay_m2pm = 0.003;
constexpr double kNoWay_m = 1000;   // between places that the coarse ways do not join
constexpr double kHeading_m = 1.0;  // the first part of a way, which the robot turns to

/// Metres that could be driven while the robot turns into the way.
double turnInto(const choices::Viewpoint& viewpoint, const Prospects& prospects,
                const robot::RobotOptions& robot) {
  const core::Pose2& here = prospects.T_map_robot;
  for (const auto node : viewpoint.way) {
    const core::Point2 p = prospects.planner.pointOf(node);
    if (core::distance(p, core::position(here)) < kHeading_m && node != viewpoint.node) continue;
    const double bearing_rad = core::atan2(p.y - here.y, p.x - here.x);
    return std::abs(core::angleDifference(bearing_rad, here.phi)) * robot.max_speed_mps /
           robot.max_turn_rate_radps;
  }
  return 0;
}

choices::TourProblem problemOf(const std::vector<choices::Look>& stops, const Prospects& prospects,
                               const robot::RobotOptions& robot) {
  choices::TourProblem problem;
  problem.stops = stops.size();
  const paths::CoarseWays ways(prospects.planner, kMostBlocks);
  std::vector<paths::PathPlanner::Node> nodes = {prospects.viewpoints[stops.front().place].way.front()};
  double all_m2 = 0;
  for (const choices::Look& stop : stops) {
    nodes.push_back(prospects.viewpoints[stop.place].node);
    all_m2 += stop.area_m2;
  }
  for (const choices::Look& stop : stops) problem.urgency.push_back(kUrgency * stop.area_m2 / all_m2);
  for (std::size_t from = 0; from < nodes.size(); ++from)
    for (const double length_m : ways.lengths(nodes[from], nodes))
      problem.leg_m.push_back(std::min(length_m, kNoWay_m));
  for (std::size_t i = 0; i < stops.size(); ++i) {
    const choices::Viewpoint& viewpoint = prospects.viewpoints[stops[i].place];
    problem.leg_m[i + 1] = viewpoint.length_m + turnInto(viewpoint, prospects, robot);
  }
  return problem;
}

}  // namespace

std::optional<std::size_t> Tour::sharedViewpoints() const {
  return kMostViewpoints;
}

bool Tour::isStillGood(const choices::Decision& decision, const core::Pose2& T_map_robot,
                       std::size_t next_waypoint) {
  if (!MapStrategy::isStillGood(decision, T_map_robot, next_waypoint)) return false;
  if (!isForALook()) return true;
  const double news = static_cast<double>(space().known) - static_cast<double>(known_cells_);
  return news * space().resolution_m * space().resolution_m < kNews_m2;
}

choices::Openings Tour::openingsOf(const Prospects& prospects) const {
  const auto frontiers = paths::findFrontiers(prospects.space, prospects.frontier_cells, 1);
  const double door_m = 2 * robot::circumscribedRadius(robot()) + kDoor_m;
  choices::Openings openings(prospects.space, frontiers, door_m, options().unknown_path_m);
  for (const auto& frontier : frontiers)
    for (const std::size_t cell : frontier.cells)
      if (isGivenUp(cell)) openings.shut(cell);
  return openings;
}

std::optional<MapStrategy::Choice> Tour::choose(const Prospects& prospects) {
  known_cells_ = space().known;
  const choices::Openings openings = openingsOf(prospects);
  std::vector<choices::Look> looks;
  for (std::size_t i = 0; i < prospects.viewpoints.size(); ++i) {
    looks.push_back(choices::lookAround(prospects.space, openings, prospects.viewpoints[i].p_map,
                                        prospects.view.max_range_m));
    looks.back().place = i;
  }
  const std::size_t cells = prospects.space.state.size();
  auto stops = choices::coveringLooks(looks, cells, kStop_m2, kMostStops);
  if (stops.empty())
    stops = choices::coveringLooks(std::move(looks), cells, options().gain_min_m2, kMostStops);
  if (stops.empty()) return std::nullopt;

  const choices::TourProblem problem = problemOf(stops, prospects, robot());
  auto order = choices::shortestTour(problem);
  double cost = choices::tourCost(problem, order);
  if (aim_) {
    const auto away_m = [&](std::size_t i) {
      return core::distance(prospects.viewpoints[stops[i].place].p_map, *aim_);
    };
    std::size_t same = 0;
    for (std::size_t i = 1; i < stops.size(); ++i)
      if (away_m(i) < away_m(same)) same = i;
    if (same != order.front() && away_m(same) < kSameStop_m) {
      auto other = choices::shortestTourFrom(problem, same);
      const double other_cost = choices::tourCost(problem, other);
      if (other_cost < cost + kHysteresis_m) order = std::move(other), cost = other_cost;
    }
  }
  const choices::Look& first = stops[order.front()];
  const choices::Viewpoint& viewpoint = prospects.viewpoints[first.place];
  const auto add = [](double sum_m2, const choices::Look& stop) { return sum_m2 + stop.area_m2; };
  const double all_m2 = std::accumulate(stops.begin(), stops.end(), 0.0, add);
  if (all_m2 < kWorthTheWay_m2pm * cost) return std::nullopt;
  aim_ = viewpoint.p_map;
  char reason[160];
  std::snprintf(reason, sizeof reason, "first of %zu stops: expects %.2f m2 of unknown, %.2f m away",
                stops.size(), first.area_m2, viewpoint.length_m);
  return Choice{first.place, -cost, reason, first.profile.bestHeading(prospects.view)};
}

}  // namespace slam::strategies
