#include "libslam/explore/exploration_referee.h"

#include <algorithm>
#include <cmath>

namespace slam::explore {
namespace {

constexpr double kNewArea_m2 = 0.1;  // less is the odd cell in a corner, as in metrics::kNewArea_m2pm
constexpr double kNewPlace_m = 1.0;

}  // namespace

std::optional<ExplorationEnd> Referee::judge(double time_s, double explored_m2,
                                             const core::Pose2& T_world_robot, bool waits) {
  if (waits) waited_s_ += time_s - judged_at_s_;
  judged_at_s_ = time_s;
  if (!place_ || core::distance(*place_, T_world_robot) >= kNewPlace_m) {
    place_ = T_world_robot;
    placed_at_s_ = time_s;
    waited_s_ = 0;
  }
  if (explored_m2 - explored_m2_ >= kNewArea_m2) {
    explored_m2_ = explored_m2;
    explored_at_s_ = time_s;
    waited_s_ = 0;
  }
  if (options_.stuck_s > 0 && time_s - std::max(placed_at_s_, explored_at_s_) - waited_s_ >= options_.stuck_s)
    return ExplorationEnd::kStuck;
  if (!returning_ && options_.give_up_s > 0 && time_s - explored_at_s_ >= options_.give_up_s)
    return ExplorationEnd::kGaveUp;
  return std::nullopt;
}

void NearMisses::look(const core::Pose2& T_world_robot) {
  const auto touches = [&](double clearance_m) {
    return world::discCollides(plan_, core::position(T_world_robot), radius_m_ + clearance_m);
  };
  if (!near_ && touches(kNearMiss_m)) near_ = true, ++count_;
  if (near_ && !touches(kNearMissOver_m)) near_ = false;
}

}  // namespace slam::explore
