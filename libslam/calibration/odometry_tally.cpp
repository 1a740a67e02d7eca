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
      if (moved_m >= largest_m_) largest_m_ = moved_m, largest_at_s_ = time_s.value_or(0);
      if (may_spin || kept_.size() >= kMostKept)
        ++sure_;
      else
        kept_.push_back({moved_m, duration_s});
    } else {
      figures_.path_m += moved_m;
      figures_.turned_rad += turned_rad;
    }
  }
  last_ = pose;
  last_s_ = time_s;
}

OdometryFigures OdometryTally::figures(const std::string& stream) const {
  OdometryFigures figures = figures_;
  figures.stream = stream;
  const double fast_mps = std::max(kFast_mps, 5 * speeds_mps_.quantile(0.95));
  figures.jumps = sure_;
  for (const auto& suspect : kept_) {
    const bool is_jump = suspect.moved_m > fast_mps * suspect.duration_s;
    figures.jumps += is_jump;
    if (!is_jump) figures.path_m += suspect.moved_m;
  }
  if (figures.jumps > 0) figures.largest_jump_m = largest_m_, figures.largest_jump_at_s = largest_at_s_;
  return figures;
}

}  // namespace slam::calibration
