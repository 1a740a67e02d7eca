#include "libslam/particles/motion.h"

#include "libslam/core/elementary.h"
#include "libslam/scanmatch/information.h"

namespace slam::particles {

Motion operator*(const Motion& first, const Motion& second) {
  const auto [s, c] = core::sinCos(first.T_previous_robot.phi);
  const core::Pose2& step = second.T_previous_robot;
  Eigen::Matrix3d by_first, by_second;
  by_first << 1, 0, -s * step.x - c * step.y, 0, 1, c * step.x - s * step.y, 0, 0, 1;
  by_second << c, -s, 0, s, c, 0, 0, 0, 1;
  return {first.T_previous_robot * step, by_first * first.covariance * by_first.transpose() +
                                             by_second * second.covariance * by_second.transpose()};
}

Eigen::Matrix3d unknownCovariance() {
  constexpr double kUnknownSigma = 0.5;
  return kUnknownSigma * kUnknownSigma * Eigen::Matrix3d::Identity();
}

Eigen::Matrix3d rotated(const Eigen::Matrix3d& matrix, double phi_rad) {
  return scanmatch::turned(matrix, -phi_rad);
}

}  // namespace slam::particles
