#include "libslam/tracking/unskewer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/lidar/deskew.h"
#include "libslam/scanmatch/information.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// Of a scan's beams no more is explained by chance.
constexpr double kLessExplained = 0.02;
/// Odometry's scatter is that of some thirty steps.
constexpr double kScatterGain = 0.03;
/// Points without noise lie no better in a map than this, in surfels' variances.
constexpr double kLeastVariance = 0.01;
/// A sweep that lasts so many steps is none, nor has a robot gone so much farther in one, or turned.
constexpr double kLongest = 2, kMostMore_m = 4, kMostMore_rad = 2;
/// Where nothing holds the robot, as along a bare corridor, the map around moves along with it: of what a
/// pose errs by against that map this share is left at the next scan. With a half it is about as good; with
/// nothing left drives without odometry are worse, with all of it corridors.
constexpr double kStaysInMap = 0.8;
/// What the pose before the first swept scan errs by.
constexpr double kFirst_m = 0.01, kFirst_rad = 0.01;

}  // namespace

/// How far steps are off what odometry says of them, by what is found of each and how sure that is.
void Unskewer::learnScatter(const scanmatch::SweptMatch& match, const Eigen::Vector3d& told,
                            const Prediction& step) {
  const Eigen::Vector3d off = match.more - told;
  const Eigen::Matrix3d squared = off * off.transpose() + match.more_covariance;
  const auto learn = [](double& scatter, double share) {
    scatter += kScatterGain * (std::min(share, 1.0) - scatter);
  };
  learn(scatter_xy_, (squared(0, 0) + squared(1, 1)) / (2 * step.sigma_xy_m * step.sigma_xy_m));
  learn(scatter_turn_, squared(2, 2) / (step.sigma_turn_rad * step.sigma_turn_rad));
}

std::optional<Unskewer::Unskewed> Unskewer::unskew(const lidar::Scan& scan, const Points& points,
                                                   const keyframes::LevelMaps& maps,
                                                   const Pose2& T_map_before, const Prediction& told,
                                                   const scanmatch::MatchResult& matched) {
  const lidar::Deskewing& by = scan.deskewing;
  const auto before = std::exchange(covariance_, std::nullopt);
  if (!(by.sweep.duration_s < kLongest * by.period_s)) return std::nullopt;
  const auto ago = scanmatch::agoOf(points, scan);
  scanmatch::SweptPrior prior;
  prior.before.mean = T_map_before * by.T_previous_robot;
  prior.before.information =
      before ? scanmatch::covarianceOf(*before) : scanmatch::poseInformation(kFirst_m, kFirst_rad);
  // Where wheels have slipped a method is told another step than the scan was deskewed by.
  const Pose2 T_told = prior.before.mean, T_step = T_map_before * told.T_previous_robot;
  prior.more << T_step.x - T_told.x, T_step.y - T_told.y, core::angleDifference(T_step.phi, T_told.phi);
  prior.step_information = scanmatch::poseInformation(std::sqrt(scatter_xy_) * told.sigma_xy_m,
                                                      std::sqrt(scatter_turn_) * told.sigma_turn_rad);
  auto options = keyframes::matchOptions(10);
  options.prior_kernel = map_->options().odometry_kernel;
  const double variance = std::max(map_->pointNoise().variance(), kLeastVariance);
  options.information_scale = 1 / (keyframes::kBothViews * variance);
  Unskewed result;
  result.match.T_map_robot = matched.T_map_robot;
  for (const auto* map : {&maps.middle, &maps.fine})
    result.match = scanmatch::alignSweptToSurfels(points, ago, *map, result.match, prior, options);
  if (!(result.match.score > matched.score - kLessExplained)) return std::nullopt;
  const Pose2& T = result.match.T_map_robot;
  const bool is_leap = !(result.match.more.head<2>().norm() < kMostMore_m) ||
                       !(std::abs(result.match.more.z()) < kMostMore_rad);
  if (is_leap) return std::nullopt;
  result.points = scanmatch::sweptBy(points, ago, result.match.more, T.phi);
  const auto [s, c] = core::sinCos(T.phi);
  const Eigen::Vector3d& more = result.match.more;
  const Pose2 T_more{c * more.x() + s * more.y(), -s * more.x() + c * more.y(), more.z()};
  const Eigen::Matrix3d new_noise = variance * result.match.by_points + result.match.by_step;
  result.noise = new_noise + result.match.by_before;
  if (!core::isFinite(T) || !core::isFinite(T_more) || !result.noise.allFinite()) return std::nullopt;
  learnScatter(result.match, prior.more, told);
  result.scan = lidar::deskewed(scan, T_more, by.period_s, by.sweep);
  covariance_ = new_noise + kStaysInMap * result.match.by_before;
  return result;
}

}  // namespace slam::tracking
