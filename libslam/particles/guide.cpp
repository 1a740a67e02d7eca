#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/particles/particle_filter.h"

/// Where the best particle goes, and what the odometry is worth at a scan.
namespace slam::particles {
namespace {

using scanmatch::FieldMatch;
using scanmatch::FieldMatchOptions;
using scanmatch::SurfacePoint;

/// A start has to beat the odometry's by this before it is taken.
constexpr double kStartMargin = 0.02;
/// Every n-th point is enough to compare starts.
constexpr int kStartStride = 3;
constexpr int kWideIterations = 4, kGuideIterations = 8;
/// Of odometry, how far a scan that nothing explains is looked for; steps within the maps' reach, and bounds.
constexpr double kSearchSigmas = 3, kSearchStep_m = 0.3, kSearchLeast_m = 0.3, kSearchMost_m = 1.2,
                 kSearchStep_rad = 0.06, kSearchLeast_rad = 0.18, kSearchMost_rad = 0.6;
/// Steps of a turn alone: in a long corridor a map explains three quarters of a scan that is turned by two
/// degrees, and half of one turned by four.
constexpr double kTurnStep_rad = 0.0175;
/// Turns of which odometry's own spread says enough.
constexpr double kAllowedSigmas = 2;
/// A map that says less of a scan cannot say that it lies elsewhere.
constexpr double kLeastTold = 0.2;
constexpr double kDistrustFactor = 3, kDistrustSigma_m = 0.1, kDistrustSigma_rad = 0.05;

/// Where a scan that nothing explains is looked for: all over what odometry allows for, in steps from which
/// matching finds home.
std::vector<core::Pose2> startsAround(const core::Pose2& T, const Eigen::Matrix3d& covariance) {
  const auto steps = [](double sigma, double step, double least, double most) {
    return static_cast<int>(std::lround(std::clamp(kSearchSigmas * sigma, least, most) / step));
  };
  const double sigma_m = std::sqrt(std::max(covariance(0, 0), covariance(1, 1)));
  const int far = steps(sigma_m, kSearchStep_m, kSearchLeast_m, kSearchMost_m);
  const int turns = steps(std::sqrt(covariance(2, 2)), kSearchStep_rad, kSearchLeast_rad, kSearchMost_rad);
  std::vector<core::Pose2> starts;
  for (int turn = -turns; turn <= turns; ++turn)
    for (int x = -far; x <= far; ++x)
      for (int y = -far; y <= far; ++y)
        starts.push_back({T.x + x * kSearchStep_m, T.y + y * kSearchStep_m, T.phi + turn * kSearchStep_rad});
  return starts;
}

core::Pose2 turnedBy(const core::Pose2& T, double turn_rad) {
  return {T.x, T.y, T.phi + turn_rad};
}

}  // namespace

/// The share of the scan that the best particle's map explains at a pose.
double ParticleFilter::explainedAt(const core::Pose2& T, const std::vector<SurfacePoint>& points) const {
  return scanmatch::fieldScore(points, particles_[best_].grid, T, options_.wide_kernel_m, kStartStride);
}

/// The share of it of which that map says anything there.
double ParticleFilter::toldAt(const core::Pose2& T, const std::vector<SurfacePoint>& points) const {
  return scanmatch::fieldTold(points, particles_[best_].grid, T, kStartStride);
}

/// Of that share, what it explains.
double ParticleFilter::explainedOfTold(const Start& at, const std::vector<SurfacePoint>& points) const {
  return std::min(at.score / std::max(toldAt(at.T_raster_robot, points), kLeastTold), 1.0);
}

/// The start that explains most: `predicted`, unless another one explains more by kStartMargin. All around it
/// is looked where none explains the scan.
ParticleFilter::Start ParticleFilter::bestStart(const Start& predicted, const Motion& expected,
                                                const std::vector<SurfacePoint>& points) const {
  const core::Pose2 T_before = particles_[best_].T_raster_robot, &step = expected.T_previous_robot;
  Start start{predicted.T_raster_robot, predicted.score + kStartMargin};
  const auto consider = [&](const core::Pose2& T, double margin) {
    const double score = explainedAt(T, points);
    if (score > start.score + margin) start = {T, score};
  };
  consider(T_before * velocity_, 0);
  consider(T_before * core::inverse(step), 0);
  for (const double turn_rad : {-0.15, -0.07, 0.07, 0.15})
    consider(turnedBy(predicted.T_raster_robot, turn_rad), 0);
  // Some robots count backwards motion forwards, and turns as they are.
  consider(T_before * core::Pose2{-step.x, -step.y, step.phi},
           way_sign_.against() / (options_.information_scale * static_cast<double>(points.size())));
  if (std::max(predicted.score, start.score - kStartMargin) < options_.insert_score)
    for (const core::Pose2& other : startsAround(predicted.T_raster_robot, expected.covariance))
      consider(other, 0);
  return start;
}

ParticleFilter::Start ParticleFilter::bestTurn(const Start& predicted,
                                               const std::vector<SurfacePoint>& points) const {
  Start best = predicted;
  for (double turn_rad = kTurnStep_rad; turn_rad <= kSearchMost_rad; turn_rad += kTurnStep_rad)
    for (const double turn : {-turn_rad, turn_rad}) {
      const core::Pose2 T = turnedBy(predicted.T_raster_robot, turn);
      if (const double score = explainedAt(T, points); score > best.score) best = {T, score};
    }
  return best;
}

/// Whether a start that explains clearly more says that odometry is wrong. It does not where a turn of
/// odometry's own spread explains as much, nor where odometry leads to ground that is new, which speaks
/// against no pose: a step back along a corridor always explains more. Where a larger turn does, odometry's
/// turn alone is distrusted.
void ParticleFilter::judgeOdometry(const Start& predicted, const std::vector<SurfacePoint>& points,
                                   Start& start, Motion& expected) {
  if (start.score <= predicted.score + options_.distrust_score) return;
  const Start turned = bestTurn(predicted, points);
  const bool is_turned = turned.score >= start.score - options_.distrust_score;
  if (is_turned) start = turned;
  Eigen::Matrix3d& covariance = expected.covariance;
  const double turn_rad = core::angleDifference(start.T_raster_robot.phi, predicted.T_raster_robot.phi);
  if (is_turned && std::abs(turn_rad) <= kAllowedSigmas * std::sqrt(covariance(2, 2))) return;
  if (explainedOfTold(start, points) <= explainedOfTold(predicted, points) + options_.distrust_score) return;
  step_.odometry_distrusted = true;
  note(core::JournalEvent::kDistrusted, start.score - predicted.score);
  expected.T_previous_robot = core::between(particles_[best_].T_raster_robot, start.T_raster_robot);
  const Eigen::Vector3d sigmas(kDistrustSigma_m, kDistrustSigma_m, kDistrustSigma_rad);
  for (int i = is_turned ? 2 : 0; i < 3; ++i)
    covariance(i, i) = 2 * (kDistrustFactor * kDistrustFactor * covariance(i, i) + sigmas(i) * sigmas(i));
}

ParticleFilter::Guidance ParticleFilter::guide(const std::vector<SurfacePoint>& points,
                                               const std::optional<Motion>& motion) {
  const Particle& best = particles_[best_];
  const core::Pose2 T_before = best.T_raster_robot;
  Motion expected = motion.value_or(Motion{velocity_, unknownCovariance()});
  Start predicted{T_before * expected.T_previous_robot, 0};
  predicted.score = explainedAt(predicted.T_raster_robot, points);
  Start start = bestStart(predicted, expected, points);
  if (motion) judgeOdometry(predicted, points, start, expected);

  Guidance guidance;
  guidance.expected = expected.T_previous_robot;
  guidance.information = expected.covariance.inverse();
  const scanmatch::PosePrior prior{T_before * guidance.expected, rotated(guidance.information, T_before.phi)};
  FieldMatchOptions wide = match_options_, fine = match_options_;
  wide.kernel_m = options_.wide_kernel_m, wide.max_iterations = kWideIterations;
  fine.max_iterations = kGuideIterations;
  const FieldMatch rough = scanmatch::alignToField(points, best.grid, start.T_raster_robot, prior, wide);
  guidance.match = scanmatch::alignToField(points, best.grid, rough.T_map_robot, prior, fine);
  guidance.moved = core::between(T_before, guidance.match.T_map_robot);
  return guidance;
}

/// Of what the best particle's map says anything of, the share that it explains. Where nearly all is new,
/// odometry is as good as it was.
double ParticleFilter::explained(const std::vector<SurfacePoint>& points, const Guidance& guidance,
                                 bool has_motion) const {
  if (guidance.match.score >= options_.insert_score) return guidance.match.score;
  const double told = toldAt(guidance.match.T_map_robot, points);
  if (told >= kLeastTold) return std::min(guidance.match.score / told, 1.0);
  return has_motion && !lost_ && !points.empty() ? 1 : guidance.match.score;
}

}  // namespace slam::particles
