#pragma once
#include <array>

#include "libslam/odometry/local_lines.h"

namespace slam::odometry {

struct PlanarFitOptions {
  int max_iterations = 30;
  int stride = 1;  ///< use every stride-th beam of the moving scan
  /// Scale of the weights and largest residual at the start; both narrow to the noise. Wide at first, because
  /// along a corridor only a few door posts tell the motion, and from a wrong start they look like outliers
  /// among walls that fit anyhow.
  double first_scale_m = 0.2, gate_m = 1;
  double narrowing = 0.7;  ///< factor on both per iteration
  /// A smaller step ends the fit, once the scale has come down to the noise. What is left after it is a small
  /// share of it.
  double still_m = 1e-4, still_rad = 3e-5;
  double max_move_m = 1;    ///< standard deviation of a direction that the scans do not determine
  double max_turn_rad = 1;  ///< the same for the turn
};

/// How one scan lies on another.
struct PlanarFit {
  core::Pose2 T_reference_moving;
  std::array<double, 9> covariance{};  ///< row-major over (x, y, phi), positive definite
  int compared = 0;                    ///< returns of the moving scan that fall into the reference's view
  int matched = 0;                     ///< of these, how many met a line there and lie on it
  double cost = 1;  ///< 0 (all matched exactly) .. 1 (nothing matched), over the compared returns
  bool degenerate =
      false;  ///< some direction is not determined by the scans (a corridor's): it was left alone
};

/// Refines a planar motion by iterated reweighted least squares of point-to-line distances: each return of
/// `moving` against the local line of the nearest return of `reference` (the metric of Censi, "An ICP variant
/// using a point-to-line metric", ICRA 2008; where that solves the rotation exactly, this takes Gauss-Newton
/// steps). Weights are Cauchy's with the scale from the residuals' median (as Jaimez et al., "Planar odometry
/// from a radial laser scanner", ICRA 2016, who robustify the range flow alike). The covariance is the
/// residual variance times the inverse normal matrix, after the information that noisy normals feign has been
/// taken off; a direction with nothing left keeps its starting value. Frames: the lidar's at both times.
PlanarFit fitPlanarMotion(const ScanLines& reference, const ScanLines& moving, const core::Pose2& guess,
                          const PlanarFitOptions& options);

}  // namespace slam::odometry
