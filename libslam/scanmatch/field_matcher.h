#pragma once
#include <Eigen/Core>

#include "libslam/gridmap/grid.h"
#include "libslam/scanmatch/pose_prior.h"
#include "libslam/scanmatch/scan_points.h"

namespace slam::scanmatch {

struct FieldMatchOptions {
  int max_iterations = 10;
  double sigma_m = 0.02;  ///< standard deviation of a point from the surface that it lies on
  double kernel_m = 0.1;  ///< Geman-McClure: a point this far off counts for a quarter
  /// How much of a point's information counts: neighbouring beams err together.
  double information_scale = 0.2;
  /// Degenerate: the scan alone leaves a direction freer than this (standard deviation).
  double degenerate_m = 0.03;
};

struct FieldMatch {
  core::Pose2 T_map_robot;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< of the scan alone, without the prior
  /// Negative log-likelihood of the scan, scaled like the information, and that of the prior.
  double cost = 0, prior_cost = 0;
  /// Mean robust weight over all points, 0..1: the share of the scan that the map explains.
  double score = 0;
  double residual_m =
      0;  ///< root mean square distance from the surfaces, by the robust weights; 0: nothing matched
  int iterations = 0;
  /// The scan leaves a direction open, as in a corridor (also: nothing matched at all). Which one, as a unit
  /// vector in the map frame, and how open: the standard deviations along it and across, from the scan alone.
  bool degenerate = false;
  core::Point2 free_direction{1, 0};
  double free_sigma_m = 0, fixed_sigma_m = 0;
};

/// Gauss-Newton on the grid's field from T_start.
///
/// Residual: the field's vector to the nearest surface, bilinear between the four cell centres around the
/// point. Of a point with a normal only the part along the normal counts, of one without both parts, at a
/// tenth of the weight. The field's derivative across a surface is -1 and that is what is used, in the
/// direction of the point's own normal: the derivative of the interpolated vectors along a wall is the noise
/// of the wall's cells, and would hold the scan along corridors (point to line: Censi, ICRA 2008; robust
/// weights as in Black and Rangarajan, IJCV 1996). Points without a surface within the grid's reach count as
/// unexplained, and so do those with a normal where the grid knows the other face of their wall alone: a wall
/// of 10 cm seen from behind would pull the scan by its thickness.
/// Cost: about 10 ns per point and iteration.
FieldMatch alignToField(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid,
                        const core::Pose2& T_start, const PosePrior& prior, const FieldMatchOptions& options);

/// The score at a pose without any alignment, from every stride-th point.
double fieldScore(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid,
                  const core::Pose2& T_map_robot, double kernel_m, int stride);

/// The share of every stride-th point of which the grid says anything at a pose: that lies near a surface, or
/// where it was looked, or beyond a wall from the robot. The rest is new. Cost: a look at the grid per cell
/// between robot and point.
double fieldTold(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid,
                 const core::Pose2& T_map_robot, int stride);

}  // namespace slam::scanmatch
