#include "libslam/odometry/normal_equations.h"

#include <Eigen/Dense>
#include <algorithm>

#include "libslam/core/middle_value.h"

namespace slam::odometry {
namespace {

constexpr double kMadToSigma = 1.4826;  // of a normal distribution
constexpr double kSmallestScale_m = 1e-3;
/// A direction counts as determined when at least this share of its information is not feigned.
constexpr double kGenuineShare = 0.3;
constexpr double kLargestStd = 0.05;  // metres (or radians): worse than this is no measurement
/// Against that of the search range: beyond, rounding would outweigh it.
constexpr double kMostInformation = 1e12;

bool isPositiveDefinite(const Eigen::Matrix3d& matrix) {
  if (!matrix.allFinite()) return false;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts((matrix + matrix.transpose()) / 2,
                                                             Eigen::EigenvaluesOnly);
  return parts.eigenvalues()[0] > 0;
}

}  // namespace

Eigen::Matrix3d OuterSum::matrix() const {
  Eigen::Matrix3d m;
  m << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  return m;
}

Directions analyse(const NormalEquations& eq, double noise_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(eq.information - eq.feigned);
  Directions d{solver.eigenvectors(), solver.eigenvalues().cwiseMax(0.0), Basis(3, 0)};
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = d.axes.col(k);
    const double whole = axis.dot(eq.information * axis);
    const double weakest = 2 * noise_m * noise_m / (kLargestStd * kLargestStd);
    if (d.genuine[k] <= std::max(kGenuineShare * whole, weakest)) {
      d.genuine[k] = 0;
      continue;
    }
    d.determined.conservativeResize(3, d.determined.cols() + 1);
    d.determined.rightCols<1>() = axis;
  }
  return d;
}

Eigen::Vector3d newtonStep(const NormalEquations& eq, const Basis& basis) {
  using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
  using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;
  if (basis.cols() == 0) return Eigen::Vector3d::Zero();
  const Square information = basis.transpose() * eq.information * basis;
  const Column gradient = basis.transpose() * eq.gradient;
  const Column solution = information.ldlt().solve(gradient);
  return -basis * solution;
}

std::array<double, 9> motionCovariance(const Directions& directions, double noise_m, double max_move_m,
                                       double max_turn_rad) {
  Eigen::Matrix3d information =
      directions.axes * (directions.genuine / (noise_m * noise_m)).asDiagonal() * directions.axes.transpose();
  const double per_move = 1 / (max_move_m * max_move_m);
  information.diagonal() += Eigen::Vector3d(per_move, per_move, 1 / (max_turn_rad * max_turn_rad));
  Eigen::Matrix3d covariance = information.inverse();
  if (!isPositiveDefinite(covariance)) {
    // In units of the search range: then every eigenvalue is 1 at least.
    const Eigen::Vector3d range(max_move_m, max_move_m, max_turn_rad);
    const Eigen::Matrix3d scaled = range.asDiagonal() * information * range.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> parts(scaled);
    covariance = parts.eigenvectors() *
                 parts.eigenvalues().cwiseMax(1).cwiseMin(kMostInformation).cwiseInverse().asDiagonal() *
                 parts.eigenvectors().transpose();
    covariance = (range.asDiagonal() * covariance * range.asDiagonal()).eval();
  }
  std::array<double, 9> out{};
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) {
      const int k = 3 * row + column;
      out[static_cast<size_t>(k)] = (covariance(row, column) + covariance(column, row)) / 2;
    }
  return out;
}

double robustScale(std::vector<double>& sizes) {
  return std::max(kMadToSigma * core::valueOfRank(sizes, sizes.size() / 2), kSmallestScale_m);
}

}  // namespace slam::odometry
