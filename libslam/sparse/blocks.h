#pragma once
#include <Eigen/Core>

namespace slam::sparse {

// Blocks of 3 x 3 in panels: scalars by columns, `height` apart. What BlockCholesky is made of.

using BlockRef = Eigen::Map<Eigen::Matrix3d, Eigen::Unaligned, Eigen::OuterStride<>>;
using ConstBlockRef = Eigen::Map<const Eigen::Matrix3d, Eigen::Unaligned, Eigen::OuterStride<>>;

inline BlockRef blockAt(double* p, long height) {
  return BlockRef(p, Eigen::OuterStride<>(height));
}
inline ConstBlockRef blockAt(const double* p, long height) {
  return ConstBlockRef(p, Eigen::OuterStride<>(height));
}

/// A factor of a product: its scalar (r, k) stands at p[r * down + k * right].
struct Factor {
  const double* p;
  long down, right;
};

/// The products of `Rows` rows of A (which stand one after the other, its columns `height` apart) with the
/// three rows of B. Summed in the order of k: one sum per scalar, whatever its vectors are.
template <class Rows>
void multiply(const double* a, long height, const Factor& b, long terms, Rows sums[3]) {
  Rows s0 = Rows::Zero(), s1 = Rows::Zero(), s2 = Rows::Zero();
  const double* row = b.p;
  for (long k = 0; k < terms; ++k, a += height, row += b.right) {
    const Eigen::Map<const Rows> column(a);
    s0 += column * row[0];
    s1 += column * row[b.down];
    s2 += column * row[2 * b.down];
  }
  sums[0] = s0, sums[1] = s1, sums[2] = s2;
}

template <class Rows>
void takeOff(double* target, long height, long from, const Rows sums[3]) {
  for (long c = 0; c < 3; ++c)
    for (long r = 0; r < 3; ++r) target[r + c * height] -= sums[c][from + r];
}

/// Takes A B^T off three columns of a target. `place(i)`: where the i-th block row of A goes.
template <class Place>
void takeOffProduct(const double* a, long height, long rows, const Factor& b, long terms, double* target,
                    long target_height, const Place& place) {
  Eigen::Matrix<double, 6, 1> two[3];
  Eigen::Vector3d one[3];
  long i = 0;
  for (; i + 1 < rows; i += 2) {
    multiply(a + 3 * i, height, b, terms, two);
    takeOff(target + 3 * place(i), target_height, 0, two);
    takeOff(target + 3 * place(i + 1), target_height, 3, two);
  }
  if (i < rows) {
    multiply(a + 3 * i, height, b, terms, one);
    takeOff(target + 3 * place(i), target_height, 0, one);
  }
}

}  // namespace slam::sparse
