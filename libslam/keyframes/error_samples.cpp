#include "libslam/keyframes/error_samples.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/random.h"
#include "libslam/keyframes/matching.h"

namespace slam::keyframes {
namespace {

using Eigen::Matrix3d;

/// A covariance from so many draws is divided by fewer: then the mean of its inverse is right (inverse
/// Wishart distribution of three dimensions, its mean known).
constexpr double kDividedBy = ErrorSamples::kCount - 4;
/// A pivot below this share of its variance is rounding.
constexpr double kLeastPivot = 1e-12;

/// Mean 0, variance 1, nearly normal: the sum of four uniform numbers.
float drawn(std::uint64_t bits) {
  constexpr double kMean = 2 * 65535.0, kVariance = 4 * (65536.0 * 65536.0 - 1) / 12;
  static const auto scale = static_cast<float>(1 / std::sqrt(kVariance));
  const std::uint64_t sum =
      (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48 & 0xffff);
  return (static_cast<float>(sum) - static_cast<float>(kMean)) * scale;
}

/// A lower triangular root; of directions without variance, nothing.
Matrix3d lowerRootOf(const Matrix3d& covariance) {
  Matrix3d root = Matrix3d::Zero();
  for (int j = 0; j < 3; ++j) {
    double pivot = covariance(j, j);
    for (int m = 0; m < j; ++m) pivot -= root(j, m) * root(j, m);
    if (!(pivot > kLeastPivot * covariance(j, j))) continue;
    root(j, j) = std::sqrt(pivot);
    for (int i = j + 1; i < 3; ++i) {
      double sum = covariance(i, j);
      for (int m = 0; m < j; ++m) sum -= root(i, m) * root(j, m);
      root(i, j) = sum / root(j, j);
    }
  }
  return root;
}

}  // namespace

void ErrorSamples::clear() {
  for (Row& row : rows_) row.fill(0);
}

void ErrorSamples::add(const Matrix3d& share, const ErrorSamples& other) {
  for (int i = 0; i < 3; ++i) {
    const auto a = static_cast<float>(share(i, 0)), b = static_cast<float>(share(i, 1)),
               c = static_cast<float>(share(i, 2));
    const float *x = other.at(0), *y = other.at(1), *phi = other.at(2);
    float* const row = rows_[static_cast<size_t>(i)].data();
    for (int s = 0; s < kCount; ++s) row[s] += a * x[s] + b * y[s] + c * phi[s];
  }
}

void ErrorSamples::addNew(const Matrix3d& covariance, std::uint64_t draw) {
  const Matrix3d root = lowerRootOf(covariance);
  ErrorSamples normal;
  std::uint64_t state = core::splitmix64(draw);
  for (Row& row : normal.rows_)
    for (float& value : row) value = drawn(core::splitmix64(state));
  add(root, normal);
}

void ErrorSamples::setSample(int i, const Eigen::Vector3d& error) {
  for (size_t row = 0; row < 3; ++row)
    rows_[row][static_cast<size_t>(i)] = static_cast<float>(error(static_cast<Eigen::Index>(row)));
}

Matrix3d ErrorSamples::covariance() const {
  Matrix3d sum;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j <= i; ++j) {
      const float *a = at(static_cast<size_t>(i)), *b = at(static_cast<size_t>(j));
      double total = 0;
      for (int s = 0; s < kCount; ++s) total += static_cast<double>(a[s]) * static_cast<double>(b[s]);
      sum(i, j) = sum(j, i) = total / kDividedBy;
    }
  return sum;
}

Matrix3d wayCovariance(const ErrorSamples& a, const core::Pose2& T_map_a, const ErrorSamples& b,
                       const core::Pose2& T_map_b) {
  const auto [s, c] = core::sinCos(T_map_a.phi);
  Matrix3d into_a;
  into_a << c, s, 0, -s, c, 0, 0, 0, 1;
  ErrorSamples way;
  way.add(into_a, b);
  way.add(-into_a * moved(core::position(T_map_a), core::position(T_map_b)), a);
  return way.covariance();
}

}  // namespace slam::keyframes
