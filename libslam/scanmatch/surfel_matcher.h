#pragma once
#include <Eigen/Core>

#include "libslam/scanmatch/surfel_map.h"

namespace slam::scanmatch {

/// What is known of a pose before the match: a Gaussian about `mean`, over (x, y, phi) in the map frame.
struct PosePrior {
  core::Pose2 mean;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  double kernel = 0;  ///< Geman-McClure on position and heading apart, in standard deviations; 0: a plain Gaussian
};

struct MatchOptions {
  int max_iterations = 10;
  double kernel = 3;             ///< Geman-McClure: in standard deviations of a surfel
  double information_scale = 1;  ///< how much of a point's information counts: neighbouring beams err together
};

struct MatchResult {
  core::Pose2 T_map_robot;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the scan alone, without the prior
  double score = 0;       ///< mean robust weight over all points, 0..1: the share of the scan that the map explains
  int iterations = 0;
};

/// Gauss-Newton from T_start: the points to the surfels of the cells that they fall into.
MatchResult alignToSurfels(const std::vector<SurfacePoint>& points, const SurfelMap& map, const core::Pose2& T_start,
                           const PosePrior& prior, const MatchOptions& options);

/// The score at a pose, without any alignment; over every `stride`-th point.
double surfelScore(const std::vector<SurfacePoint>& points, const SurfelMap& map, const core::Pose2& T_map_robot,
                   double kernel, int stride);

}  // namespace slam::scanmatch
