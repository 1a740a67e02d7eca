#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

namespace slam::odometry {

/// What the iterated reweighted least squares of this room share. All are over (x, y, phi).

/// Holland and Welsch, "Robust regression using iteratively reweighted least-squares" (1977): this multiple
/// of the noise gives Cauchy's weights 95 % efficiency under Gaussian noise.
inline constexpr double kCauchy = 2.385;

/// Sum of weighted outer products of 3-vectors, upper half.
struct OuterSum {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  void add(double w, double x, double y, double z) {
    const double wx = w * x, wy = w * y;
    xx += wx * x, xy += wx * y, xz += wx * z, yy += wy * y, yz += wy * z, zz += w * z * z;
  }
  Eigen::Matrix3d matrix() const;
};

struct NormalEquations {
  Eigen::Matrix3d information;  ///< sum of w J J^T
  Eigen::Matrix3d feigned;      ///< what noise of the normals adds to it on average
  Eigen::Vector3d gradient;     ///< sum of w r J
  int inliers = 0;
};

/// Columns span the directions that the scans determine; none to three.
using Basis = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

/// Genuine information along orthogonal directions, and those of them that have enough.
struct Directions {
  Eigen::Matrix3d axes;
  Eigen::Vector3d genuine;  ///< 0 where undetermined
  Basis determined;
};

/// Takes off what is feigned. noise_m: of the ranges.
Directions analyse(const NormalEquations& equations, double noise_m);

/// The Gauss-Newton step within the determined directions (as Zhang, Kaess and Singh, "On degeneracy of
/// optimization-based state estimation problems", ICRA 2016).
Eigen::Vector3d newtonStep(const NormalEquations& equations, const Basis& determined);

/// Residual variance times the inverse of the genuine information, with the prior's variance (move, move,
/// turn) where there is none; row-major.
std::array<double, 9> motionCovariance(const Directions& directions, double residual_noise_m,
                                       double max_move_m, double max_turn_rad);

/// Standard deviation from the median of sizes, at least 1 mm, which keeps noise-free scans from dividing by
/// zero. Reorders `sizes`. REQUIRES at least one.
double robustScale(std::vector<double>& sizes);

}  // namespace slam::odometry
