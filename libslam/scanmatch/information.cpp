#include "libslam/scanmatch/information.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::scanmatch {
namespace {

/// An edge tells at least so much of every direction, absolutely and against the one that it tells most of.
constexpr double kLeastInformation = 1e-6, kLeastShare = 1e-9;
/// The same before a matrix is inverted.
constexpr double kLeastInvertible = 1e-12;

using Decomposition = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>;

Eigen::Matrix3d composed(const Decomposition& of, const Eigen::Vector3d& eigenvalues) {
  const Eigen::Matrix3d sum = of.eigenvectors() * eigenvalues.asDiagonal() * of.eigenvectors().transpose();
  return 0.5 * (sum + sum.transpose());
}

Decomposition decomposed(const Eigen::Matrix3d& matrix) {
  return Decomposition(0.5 * (matrix + matrix.transpose()));
}

}  // namespace

Eigen::Matrix3d poseInformation(double sigma_xy_m, double sigma_turn_rad) {
  const double xy = 1 / (sigma_xy_m * sigma_xy_m);
  return Eigen::Vector3d(xy, xy, 1 / (sigma_turn_rad * sigma_turn_rad)).asDiagonal();
}

Eigen::Matrix3d withoutNegatives(const Eigen::Matrix3d& matrix, double least_share, double least) {
  const auto parts = decomposed(matrix);
  const double floor = std::max(least, least_share * parts.eigenvalues().maxCoeff());
  return composed(parts, parts.eigenvalues().cwiseMax(floor));
}

Eigen::Matrix3d turned(const Eigen::Matrix3d& information, double phi_rad) {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  turn(0, 0) = turn(1, 1) = core::cos(phi_rad);
  turn(1, 0) = core::sin(phi_rad), turn(0, 1) = -turn(1, 0);
  return turn.transpose() * information * turn;
}

Eigen::Matrix3d edgeInformation(const Eigen::Matrix3d& information, double phi_rad) {
  return withoutNegatives(turned(information, phi_rad), kLeastShare, kLeastInformation);
}

Eigen::Matrix3d rootOf(const Eigen::Matrix3d& covariance) {
  const auto parts = decomposed(covariance);
  return composed(parts, parts.eigenvalues().cwiseMax(0.0).cwiseSqrt());
}

Eigen::Matrix3d covarianceOf(const Eigen::Matrix3d& information) {
  const auto parts = decomposed(information);
  const double most = parts.eigenvalues().maxCoeff();
  const double floor = most > 0 ? kLeastInvertible * most : kLeastInvertible;
  return composed(parts, parts.eigenvalues().cwiseMax(floor).cwiseInverse());
}

ToldShares toldShares(const Eigen::Matrix3d& information, const Eigen::Matrix3d& posterior,
                      const core::Pose2& T_step, double phi_rad) {
  const auto [s, c] = core::sinCos(phi_rad);
  const Eigen::Vector3d way(c * T_step.x - s * T_step.y, s * T_step.x + c * T_step.y, 0);
  const Eigen::Matrix3d told = posterior.ldlt().solve(information);
  return {way.squaredNorm() > 0 ? way.dot(told * way) / way.squaredNorm() : 1, told(2, 2)};
}

}  // namespace slam::scanmatch
