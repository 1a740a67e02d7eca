#include "libslam/keyframes/matching.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace slam::keyframes {
namespace {

using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

constexpr double kDistinctShifts_m[] = {-1.5, -1, -0.6, -0.35, 0.35, 0.6, 1, 1.5};
constexpr double kDistinctKernel = 3;
/// What coarser maps find is where the next finer one begins: a fraction of its cells is near enough.
constexpr double kNearEnough_m = 0.005, kNearEnough_rad = 0.002;

}  // namespace

scanmatch::MatchOptions matchOptions(int max_iterations) {
  scanmatch::MatchOptions options;
  options.kernel = kKernel;
  options.information_scale = scanmatch::kInformationScale;
  options.max_iterations = max_iterations;
  return options;
}

std::vector<PatchPoint> pointsOf(const lidar::Scan& scan, const GraphOptions& o) {
  scanmatch::ScanPointOptions options;
  options.spacing_m = o.point_spacing_m;
  options.max_range_m = o.max_range_m;
  return patchPoints(scan, options);
}

core::Point2 centreOf(const std::vector<PatchPoint>& points) {
  core::Point2 sum;
  for (const auto& point : points) sum.x += point.x, sum.y += point.y;
  const auto count = static_cast<double>(std::max<size_t>(points.size(), 1));
  return {sum.x / count, sum.y / count};
}

MatchResult match(const std::vector<PatchPoint>& points, const LevelMaps& maps, const Pose2& T_start,
                  const PosePrior& prior, double prior_kernel, bool with_coarse) {
  auto options = matchOptions(10);
  options.prior_kernel = prior_kernel;
  auto coarser = options;
  coarser.max_iterations = 3;
  coarser.still_m = kNearEnough_m, coarser.still_rad = kNearEnough_rad;
  Pose2 T = T_start;
  if (with_coarse) T = alignToSurfels(points, maps.coarse, T, prior, coarser).T_map_robot;
  T = alignToSurfels(points, maps.middle, T, prior, coarser).T_map_robot;
  return alignToSurfels(points, maps.fine, T, prior, options);
}

Eigen::Matrix3d toldInformation(const scanmatch::MatchEvidence& evidence) {
  return scanmatch::kInformationScale * evidence.information();
}

Eigen::Matrix3d toldInformation(const std::vector<PatchPoint>& points, const scanmatch::SurfelMap& map,
                                const Pose2& T_map_robot) {
  return toldInformation(evidenceOf(points, map, T_map_robot, kKernel, scanmatch::Walls::kFacing));
}

double distinctness(const std::vector<PatchPoint>& points, const LevelMaps& maps,
                    const scanmatch::MatchResult& matched) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> movement(matched.information.topLeftCorner<2, 2>());
  const Eigen::Vector2d weakest = movement.eigenvectors().col(0);
  const Pose2& T = matched.T_map_robot;
  const double here = surfelScore(points, maps.middle, T, kDistinctKernel, 1);
  double elsewhere = 0;
  for (const double shift_m : kDistinctShifts_m)
    elsewhere =
        std::max(elsewhere, surfelScore(points, maps.middle,
                                        {T.x + shift_m * weakest.x(), T.y + shift_m * weakest.y(), T.phi},
                                        kDistinctKernel, 1));
  return here - elsewhere;
}

std::vector<int> firstOf(std::vector<int> keyframes, int most) {
  if (static_cast<int>(keyframes.size()) > most) keyframes.resize(static_cast<size_t>(most));
  return keyframes;
}

}  // namespace slam::keyframes
