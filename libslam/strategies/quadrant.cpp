#include "libslam/strategies/quadrant.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "libslam/core/elementary.h"
#include "libslam/safety/view.h"

namespace slam::strategies {
namespace {

constexpr std::array<const char*, 4> kNames = {"front-left", "rear-left", "rear-right", "front-right"};
constexpr double kLeadsBack_rad = core::kPi / 4;
// Turning, backing off and odometry noise do not make a new place.
constexpr double kNewPlace_m = 0.5;

/// The longest ray of every quadrant that the lidar sees, nothing where it sees none.
std::array<std::optional<safety::SeenBeam>, 4> longestRays(const std::vector<safety::SeenBeam>& beams) {
  std::array<std::optional<safety::SeenBeam>, 4> longest;
  for (const auto& beam : beams) {
    auto& best = longest[static_cast<size_t>(safety::quadrantOf(beam.angle_rad))];
    if (!best || beam.range_m > best->range_m) best = beam;
  }
  return longest;
}

}  // namespace

void Quadrant::rememberWay(const core::Pose2& T_odom_robot) {
  if (!T_odom_here_) T_odom_here_ = T_odom_robot;
  const double new_place_m = std::max(kNewPlace_m, 2 * options_.back_off_m);
  if (core::distance(*T_odom_here_, T_odom_robot) < new_place_m) return;
  T_odom_from_ = T_odom_here_;
  T_odom_here_ = T_odom_robot;
}

bool Quadrant::leadsBack(double angle_rad, const core::Pose2& T_odom_robot) const {
  if (!T_odom_from_) return false;
  const core::Pose2 T_robot_from = core::between(T_odom_robot, *T_odom_from_);
  const double back_rad = core::atan2(T_robot_from.y, T_robot_from.x);
  return std::abs(core::angleDifference(angle_rad, back_rad)) <= kLeadsBack_rad;
}

choices::Decision Quadrant::decide(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
  rememberWay(T_odom_robot);
  // Drawn whatever the scan holds, so that one empty scan does not shift the later draws.
  const double divisor = random_.uniform(options_.divisor_min, options_.divisor_max);
  const auto candidates = longestRays(safety::seenBeams(scan));

  std::optional<size_t> onward, back;
  for (size_t q = 0; q < candidates.size(); ++q) {
    if (!candidates[q]) continue;
    auto& best = leadsBack(candidates[q]->angle_rad, T_odom_robot) ? back : onward;
    if (!best || candidates[q]->range_m > candidates[*best]->range_m) best = q;
  }
  const bool dead_end = !onward || candidates[*onward]->range_m <= options_.stop_clearance_m;
  const std::optional<size_t> choice = dead_end && back ? back : onward;

  choices::Decision decision;
  decision.reason = "no valid reading";
  if (!choice) return decision;
  const safety::SeenBeam& chosen = *candidates[*choice];
  decision.turn_rad = core::wrapToPi(chosen.angle_rad);
  decision.distance_m = chosen.range_m / divisor;
  decision.score = chosen.range_m;
  decision.ray_m = chosen.range_m;
  char reason[100];
  std::snprintf(reason, sizeof reason, "%s: longest ray %.2f m at %.0f deg%s", kNames[*choice],
                chosen.range_m, core::radToDeg(decision.turn_rad), choice == back ? ", the way back" : "");
  decision.reason = reason;
  for (size_t q = 0; q < candidates.size(); ++q) {
    if (!candidates[q] || q == *choice) continue;
    const auto& [angle_rad, range_m] = *candidates[q];
    decision.alternatives.push_back(core::polar(range_m, angle_rad));
  }
  return decision;
}

}  // namespace slam::strategies
