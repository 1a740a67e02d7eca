#include "libslam/choices/certainty.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libslam/paths/coarse_ways.h"

namespace slam::choices {
namespace {

constexpr double kSquare_m = 1;      // one place each
constexpr double kHere_m = 2;        // nearer than this a loop would have been closed without going there
constexpr double kStep_m = 1;        // between two scans: more is a correction of the pose
constexpr double kNoWay_m = 1e6;     // between places that the coarse ways do not join
constexpr double kAround_m = 5;      // of where a way back ends: seen from there, too
constexpr double kOnTheWay_m = 0.5;  // of detour: the robot comes there without it
constexpr std::size_t kMostBlocks = 10000;
constexpr double kLeft = 0.5;  // of a gain: with less to come the way on is better

std::pair<int, int> squareOf(const core::Point2& p_map) {
  return {static_cast<int>(std::floor(p_map.x / kSquare_m)),
          static_cast<int>(std::floor(p_map.y / kSquare_m))};
}

}  // namespace

void Certainty::see(const core::Pose2& T_map_robot) {
  if (!spread_m_ || !core::isFinite(T_map_robot)) return;
  if (last_) driven_m_ += std::min(kStep_m, core::distance(*last_, T_map_robot));
  last_ = T_map_robot;
  const core::Point2 p = core::position(T_map_robot);
  places_.insert_or_assign(squareOf(p), Place{p, *spread_m_});
}

bool Certainty::mayPay() const {
  if (!last_ || !(price_ > 0)) return false;
  return std::any_of(places_.begin(), places_.end(), [&](const auto& entry) {
    const Place& place = entry.second;
    const double away_m = core::distance(place.p_map, core::position(*last_));
    // The least detour to anywhere is none: what counts is whether there is anything to gain at all.
    return away_m >= kHere_m && *spread_m_ - place.spread_m >= kLeastGain_m && budget_m() > 0;
  });
}

std::optional<Certainty::Return> Certainty::best(const paths::FreeSpace& space,
                                                 const paths::PathPlanner& planner,
                                                 std::optional<paths::PathPlanner::Node> next) const {
  if (!mayPay()) return std::nullopt;
  std::vector<Return> returns;
  std::vector<paths::PathPlanner::Node> nodes;
  for (const auto& [square, place] : places_) {
    const int column = space.columnOf(place.p_map.x), row = space.rowOf(place.p_map.y);
    const double gain_m = *spread_m_ - place.spread_m;
    if (gain_m < kLeastGain_m || !space.contains(column, row) ||
        core::distance(place.p_map, core::position(*last_)) < kHere_m)
      continue;
    const auto node = planner.nodeOf(space.index(column, row));
    if (!planner.isReached(node)) continue;
    returns.push_back({node, place.p_map, gain_m, planner.cost(node), place.spread_m});
    nodes.push_back(node);
  }
  if (returns.empty()) return std::nullopt;
  if (next) {
    const auto on_m = paths::CoarseWays(planner, kMostBlocks).lengths(*next, nodes);
    for (std::size_t i = 0; i < returns.size(); ++i)
      returns[i].detour_m =
          std::max(0.0, returns[i].detour_m + std::min(on_m[i], kNoWay_m) - planner.cost(*next));
  }
  const auto profit = [&](const Return& r) { return price_ * r.gain_m - r.detour_m; };
  std::optional<Return> best;
  for (const Return& one : returns)
    if (pays(one.gain_m, one.detour_m) && (!best || profit(one) > profit(*best))) best = one;
  if (best && best->detour_m < kOnTheWay_m) return std::nullopt;
  return best;
}

bool Certainty::isDone(const Return& chosen) const {
  return *spread_m_ - chosen.spread_m < kLeft * chosen.gain_m;
}

void Certainty::end(const core::Point2& p_map) {
  for (auto& [square, place] : places_)
    if (core::distance(place.p_map, p_map) < kAround_m) place.spread_m = std::max(place.spread_m, *spread_m_);
}

}  // namespace slam::choices
