#pragma once
#include <Eigen/Core>

#include "libslam/core/pose2.h"

namespace slam::scanmatch {

/// Neighbouring beams err together, and surfels are estimates: a point of a match tells a fifth of what an
/// independent one would.
inline constexpr double kInformationScale = 0.2;
/// The time that odometry's standard deviations are given for; they grow with its root.
inline constexpr double kNominalPeriod_s = 0.2;

/// Over (x, y, phi), m and rad, without correlation. REQUIRES positive standard deviations.
Eigen::Matrix3d poseInformation(double sigma_xy_m, double sigma_turn_rad);

/// Information over (x, y, phi) in the map's axes, in those of a body that is turned so in it.
Eigen::Matrix3d turned(const Eigen::Matrix3d& information, double phi_rad);

/// What an edge carries of a match: its information over (x, y, phi), position in the map's axes, turned into
/// the body's own. Symmetric and positive definite by construction, also where the match left directions
/// open, or rounding has put an eigenvalue below zero: see withoutNegatives().
Eigen::Matrix3d edgeInformation(const Eigen::Matrix3d& information, double phi_rad);

/// Of what holds a match, the share that the scan told, in [0, 1]; the rest is its prior's word.
struct ToldShares {
  double way;   ///< along the step; 1 where that is none: standing still odometry has nothing to say either
  double turn;  ///< of the heading
};
/// `information`: of the scan alone; `posterior`: of scan and prior, positive definite; map axes. `T_step`:
/// in the frame of a robot with heading phi_rad.
ToldShares toldShares(const Eigen::Matrix3d& information, const Eigen::Matrix3d& posterior,
                      const core::Pose2& T_step, double phi_rad);

/// The symmetric part of a matrix, with eigenvalues raised to `least_share` of the largest, and to `least`.
/// Zero gives least times the identity. REQUIRES finite entries, least_share in [0, 1] and least >= 0.
Eigen::Matrix3d withoutNegatives(const Eigen::Matrix3d& matrix, double least_share, double least);

/// The symmetric root of a covariance, or of what rounding has left of it.
Eigen::Matrix3d rootOf(const Eigen::Matrix3d& covariance);

/// The covariance of an information matrix, which may have lost rank: eigenvalues count as at least 1e-12 of
/// the largest, so that the result is finite, symmetric and positive definite. Zero gives the identity times
/// 1e12.
Eigen::Matrix3d covarianceOf(const Eigen::Matrix3d& information);

}  // namespace slam::scanmatch
