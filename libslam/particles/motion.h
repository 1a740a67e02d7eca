#pragma once
#include <Eigen/Core>

#include "libslam/core/pose2.h"

namespace slam::particles {

/// The motion since the scan before, as the wheels or the scans alone tell it.
struct Motion {
  core::Pose2 T_previous_robot;
  Eigen::Matrix3d covariance;  ///< over (x, y, phi) in the previous robot's frame; positive definite
};

/// Two motions, one after the other, with independent errors; covariance to first order, in the frame before
/// both.
Motion operator*(const Motion& first, const Motion& second);
/// Of a motion that nobody measured: 0.5 m and 0.5 rad.
Eigen::Matrix3d unknownCovariance();
/// A covariance or information over (x, y, phi) from a frame into the one in which that is turned by phi_rad.
Eigen::Matrix3d rotated(const Eigen::Matrix3d& matrix, double phi_rad);

}  // namespace slam::particles
