#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>

#include "libslam/core/pose2.h"

namespace slam::keyframes {

/// What a pose may err by, drawn kCount times: x, y (m), phi (rad), map frame. Poses that take over each
/// other's errors have them in common draw by draw, however many ways they came: so two that lie a metre
/// apart are known to err alike, after a kilometre, too. Monte Carlo in place of covariances that would have
/// to be kept of every pair (ensembles: Evensen, J. Geophys. Res. 99, 1994). For the rooms of graph SLAM
/// only.
class ErrorSamples {
 public:
  static constexpr int kCount = 64;
  /// No error.
  ErrorSamples() { clear(); }
  void clear();
  /// `share` times what another pose errs by comes to it.
  void add(const Eigen::Matrix3d& share, const ErrorSamples& other);
  /// Something new comes to it. `draw`: whatever has the same number is drawn alike. REQUIRES a covariance,
  /// or what rounding has left of it.
  void addNew(const Eigen::Matrix3d& covariance, std::uint64_t draw);
  Eigen::Vector3d sample(int i) const { return {at(0)[i], at(1)[i], at(2)[i]}; }
  void setSample(int i, const Eigen::Vector3d& error);
  /// Of its error; so that squared errors by it (NEES) are right in the mean, and have the tails of kCount
  /// draws.
  Eigen::Matrix3d covariance() const;

 private:
  using Row = std::array<float, kCount>;
  const float* at(size_t row) const { return rows_[row].data(); }
  std::array<Row, 3> rows_;
};

/// How sure b's pose is in a's frame: covariance of x (m), y (m), phi (rad).
Eigen::Matrix3d wayCovariance(const ErrorSamples& a, const core::Pose2& T_map_a, const ErrorSamples& b,
                              const core::Pose2& T_map_b);

}  // namespace slam::keyframes
