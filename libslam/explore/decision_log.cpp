#include "libslam/explore/decision_log.h"

#include <algorithm>

namespace slam::explore {
namespace {

bool areSame(const std::vector<core::Point2>& a, const std::vector<core::Point2>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const core::Point2& p, const core::Point2& q) { return p.x == q.x && p.y == q.y; });
}

}  // namespace

core::Point2 goalInMap(const DecisionEntry& entry) {
  const auto& d = entry.decision;
  if (!d.path.empty()) return d.goal;
  return entry.T_map_robot * core::polar(d.distance_m, d.turn_rad);
}

bool isSame(const choices::Decision& a, const choices::Decision& b) {
  return a.turn_rad == b.turn_rad && a.distance_m == b.distance_m && a.score == b.score &&
         a.finished == b.finished && a.reason == b.reason && areSame(a.path, b.path) &&
         areSame(a.alternatives, b.alternatives);
}

table::Table decisionTable(const std::vector<DecisionEntry>& decisions) {
  table::Table table;
  for (const char* key : {"time_s", "map_x_m", "map_y_m", "map_yaw_rad", "goal_x_m", "goal_y_m", "score",
                          "spread_m", "certainty_m", "waypoints", "alternatives", "reason"})
    table.columns.push_back({key, key, 3});
  for (const auto& entry : decisions) {
    const auto goal = goalInMap(entry);
    const auto& decision = entry.decision;
    table.rows.push_back({entry.time_s, entry.T_map_robot.x, entry.T_map_robot.y, entry.T_map_robot.phi,
                          goal.x, goal.y, decision.score, decision.spread_m, decision.certainty_m,
                          static_cast<double>(decision.path.size()),
                          static_cast<double>(decision.alternatives.size()), decision.reason});
  }
  return table;
}

}  // namespace slam::explore
