#include <algorithm>

#include "libslam/core/elementary.h"
#include "libslam/particles/particle_filter.h"
#include "libslam/scanmatch/information.h"

namespace slam::particles {

/// The motion as far as the wheels are believed, set right by what the drive so far showed of them.
std::optional<Motion> ParticleFilter::believed(std::optional<Motion> motion, double time_s) {
  const double since_s = time_s - previous_time_s_;
  previous_time_s_ = time_s;
  if (!motion || scans_ == 0) return std::nullopt;
  const core::Pose2& T = motion->T_previous_robot;
  if (leaps_.take(T, since_s)) {
    note(core::JournalEvent::kLeapt, core::hypot(T.x, T.y));
    return std::nullopt;
  }
  if (silence_.take(T)) return std::nullopt;
  motion->T_previous_robot = wheels_.corrected(T);
  double& turn_variance = motion->covariance(2, 2);
  const double scatter_rad = wheels_.sigmaTurn_rad(motion->T_previous_robot);
  turn_variance = std::max(turn_variance, scatter_rad * scatter_rad);
  return motion;
}

/// What a step that the best particle's map explains shows of the wheels.
void ParticleFilter::learnWheels(const std::optional<Motion>& motion, const core::Pose2& T_before) {
  if (!step_.lost && silence_.note(velocity_)) note(core::JournalEvent::kSilent, 0);
  const Particle& best = particles_[best_];
  if (!motion || step_.lost || step_.score < options_.insert_score) return wheels_.endPiece();
  const core::Pose2& step = motion->T_previous_robot;
  const auto told = scanmatch::toldShares(best.match.information, best.information, step, T_before.phi);
  const core::Pose2 matched = core::between(T_before, best.match.T_map_robot);
  way_sign_.learn(step, matched, told.way);
  if (step_.odometry_distrusted) return wheels_.endPiece();
  wheels_.learn(step, matched, told.way, told.turn);
}

}  // namespace slam::particles
