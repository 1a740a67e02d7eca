#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "libslam/scanmatch/pose_prior.h"
#include "libslam/scanmatch/surfel_map.h"

namespace slam::scanmatch {

struct MatchOptions {
  int max_iterations = 10;
  double still_m = 3e-4, still_rad = 1e-4;  ///< a step below both is the last
  double kernel = 3;                        ///< Geman-McClure, in standard deviations of a surfel
  /// The same for the prior, on position and heading apart: what contradicts the scan lets go. 0: a plain
  /// Gaussian.
  double prior_kernel = 0;
  /// How much of a point's information counts: neighbouring beams err together.
  double information_scale = 1;
};

struct MatchResult {
  core::Pose2 T_map_robot;
  /// Over x, y (m) and phi (rad) in the map frame: of the scan alone, and with what was left of the prior.
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero(), posterior_information = Eigen::Matrix3d::Zero();
  double score = 0;  ///< mean robust weight of the points within the map's window, 0..1: the share of the
                     ///< scan that it explains
};

/// Gauss-Newton from T_start: the points (robot frame) to the surfels of the cells that they fall into.
/// Without points the start, and no information. Cost: some 10 ns per point and iteration.
MatchResult alignToSurfels(const std::vector<PatchPoint>& points, const SurfelMap& map,
                           const core::Pose2& T_start, const PosePrior& prior, const MatchOptions& options);

/// What a scan tells of its pose, by the view (see SurfelMap::add()) that saw the surfaces first.
struct ViewInformation {
  int view;
  /// How firmly its surfaces hold the pose: over x, y (m) and phi (rad) in the map frame, as if points were
  /// independent, and without what the errors of the surfels' directions feign (see SurfelMap::feignedBy()):
  /// along a bare corridor it is nothing give or take a little, and may be below zero. A point that lies off
  /// pulls the less the farther it is off, so that this is the slope of the robust pull, and less than its
  /// weights times the surfels' information (Huber, Robust Statistics, 1981, on M-estimates).
  Eigen::Matrix3d information;
};
struct MatchEvidence {
  std::vector<ViewInformation> by_view;  ///< ascending
  /// Sums over the points of their squared residuals in standard deviations of the surfels, of the dimensions
  /// that these measure, and of products with the residuals of the points after it, up to kLags.
  static constexpr int kLags = 5;
  double squared = 0, dimensions = 0;
  std::array<double, kLags> lagged{};
  /// As `squared`, of the robust pulls: each residual counts its weight times as much.
  double pulled = 0;
  /// By how much those weights tell more than that slope.
  Eigen::Matrix3d beyond_slope = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d slope() const;                                          ///< by all views
  Eigen::Matrix3d information() const { return slope() + beyond_slope; }  ///< by the weights
};
/// kFacing: a wall of which the map knows the other side alone tells nothing. By how much its points are off,
/// the wall's thickness, is the same for all, so that many of them are no surer than one; beside other walls
/// they count for little, but where there are no others they would be believed.
enum class Walls { kAll, kFacing };
MatchEvidence evidenceOf(const std::vector<PatchPoint>& points, const SurfelMap& map,
                         const core::Pose2& T_map_robot, double kernel, Walls walls = Walls::kAll);

/// The score at a pose, without any alignment; over every `stride`-th point. Points outside of the map's
/// window are not held against the pose, as long as a quarter of all lies inside. A score that cannot be
/// above `least` is given up half-way: 0.
double surfelScore(const std::vector<PatchPoint>& points, const SurfelMap& map,
                   const core::Pose2& T_map_robot, double kernel, int stride, double least = -1);

}  // namespace slam::scanmatch
