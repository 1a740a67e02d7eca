#include "libslam/particles/sweeps.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::particles {

/// The map of the keyframes around, made anew when another tells where the robot is.
void Sweeps::lookAround(const core::Pose2& T_map_robot) {
  const auto& map = past_->map();
  if (keyframes_ == map.size() && anchor_ == past_->anchor() && revision_ == map.revision()) return;
  around_.fillAround(past_->anchor(), T_map_robot);
  keyframes_ = map.size(), anchor_ = past_->anchor(), revision_ = map.revision();
}

std::optional<Sweeps::SetRight> Sweeps::setRight(const lidar::Scan& scan, const core::Pose2& T_before,
                                                 const Motion& told) {
  const auto& options = past_->map().options();
  const bool is_deskewed = scan.deskewing.sweep.duration_s > 0 && scan.deskewing.period_s > 0;
  if (!is_deskewed || past_->anchor() < 0) return std::nullopt;
  lookAround(T_before);
  const auto points = keyframes::pointsOf(scan, options);
  const tracking::Prediction step{told.T_previous_robot,
                                  std::sqrt(std::max(told.covariance(0, 0), told.covariance(1, 1))),
                                  std::sqrt(told.covariance(2, 2))};
  scanmatch::PosePrior prior;
  prior.mean = T_before * told.T_previous_robot;
  prior.information = scanmatch::poseInformation(step.sigma_xy_m, step.sigma_turn_rad);
  const auto matched =
      keyframes::match(points, around_.maps(), prior.mean, prior, options.odometry_kernel, true);
  if (points.empty() || around_.isPoor(matched, points)) {
    unskewer_.forget();
    return std::nullopt;
  }
  auto right = unskewer_.unskew(scan, points, around_.maps(), T_before, step, matched);
  if (!right) return std::nullopt;
  return SetRight{std::move(right->scan), right->noise};
}

}  // namespace slam::particles
