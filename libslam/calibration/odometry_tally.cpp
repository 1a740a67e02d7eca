#include "libslam/calibration/odometry_tally.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::calibration {

void OdometryTally::add(std::optional<double> time_s, const core::Pose2& pose) {
  ++figures_.readings;
  if (last_) {
    const auto step = core::between(*last_, pose);
    const double moved_m = core::hypot(step.x, step.y), turned_rad = std::abs(core::wrapToPi(step.phi));
    const bool has_time = time_s && last_s_ && *time_s > *last_s_;
    const double duration_s = has_time ? *time_s - *last_s_ : 0;
    if (has_time && moved_m > 0) speeds_mps_.add(moved_m / duration_s);
    const bool may_jump = moved_m > kShortest_m && moved_m > kFast_mps * duration_s;
    const bool may_spin = turned_rad > kSmallest_rad && turned_rad > kFast_radps * duration_s;
    if (may_jump || may_spin) {
      if (may_spin || kept_.size() >= kMostKept)
        note(figures_, moved_m, time_s.value_or(0));
      else
        kept_.push_back({moved_m, turned_rad, duration_s, time_s.value_or(0)});
    } else {
      figures_.path_m += moved_m;
      figures_.turned_rad += turned_rad;
    }
  }
  last_ = pose;
  last_s_ = time_s;
}

/// A jump; of equally long ones the last counts as the largest.
void OdometryTally::note(OdometryFigures& figures, double moved_m, double at_s) {
  ++figures.jumps;
  if (moved_m >= figures.largest_jump_m) figures.largest_jump_m = moved_m, figures.largest_jump_at_s = at_s;
}

OdometryFigures OdometryTally::figures(const std::string& stream) const {
  OdometryFigures figures = figures_;
  figures.stream = stream;
  const double fast_mps = std::max(kFast_mps, 5 * speeds_mps_.quantile(0.95));
  for (const auto& suspect : kept_) {
    if (suspect.moved_m > fast_mps * suspect.duration_s)
      note(figures, suspect.moved_m, suspect.at_s);
    else
      figures.path_m += suspect.moved_m, figures.turned_rad += suspect.turned_rad;
  }
  return figures;
}

}  // namespace slam::calibration
