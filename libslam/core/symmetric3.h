#pragma once
#include <Eigen/Core>

namespace slam::core {

/// A symmetric 3x3 matrix, such as the covariance of a pose, in 48 bytes: what is kept of every scan.
class Symmetric3 {
 public:
  Symmetric3() = default;
  /// Of the matrix its diagonal and what is above.
  template <class Derived>
  Symmetric3(const Eigen::MatrixBase<Derived>& whole) {  // NOLINT(google-explicit-constructor): the same
    const Eigen::Matrix3d m = whole;
    xx_ = m(0, 0), xy_ = m(0, 1), xz_ = m(0, 2), yy_ = m(1, 1), yz_ = m(1, 2), zz_ = m(2, 2);
  }

  Eigen::Matrix3d matrix() const {
    Eigen::Matrix3d m;
    m << xx_, xy_, xz_, xy_, yy_, yz_, xz_, yz_, zz_;
    return m;
  }
  bool isZero() const { return xx_ == 0 && xy_ == 0 && xz_ == 0 && yy_ == 0 && yz_ == 0 && zz_ == 0; }

 private:
  double xx_ = 0, xy_ = 0, xz_ = 0, yy_ = 0, yz_ = 0, zz_ = 0;
};

}  // namespace slam::core
