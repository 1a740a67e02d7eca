#pragma once
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>

namespace slam::mapping::test {

/// Finite, and not negative in any direction, to rounding.
inline bool isCovariance(const Eigen::Matrix3d& matrix) {
  if (!matrix.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(matrix, Eigen::EigenvaluesOnly);
  return parts.eigenvalues()[0] >= -1e-9 * std::max(parts.eigenvalues()[2], 1e-12);
}

}  // namespace slam::mapping::test
