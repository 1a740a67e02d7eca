#include "libslam/core/symmetric3.h"

#include <gtest/gtest.h>

namespace slam::core {
namespace {

TEST(Symmetric3, IsTheDiagonalAndWhatIsAboveIt) {
  Eigen::Matrix3d m, same;
  m << 1, 2, 3, -7, 4, 5, -8, -9, 6;
  same << 1, 2, 3, 2, 4, 5, 3, 5, 6;
  EXPECT_EQ(Symmetric3(m).matrix(), same);
  EXPECT_EQ(Symmetric3(2 * same).matrix(), 2 * same);  // of an expression, too
  EXPECT_EQ(sizeof(Symmetric3), 48U);
}

TEST(Symmetric3, IsZeroWhereEveryEntryIs) {
  EXPECT_TRUE(Symmetric3().isZero());
  EXPECT_EQ(Symmetric3().matrix(), Eigen::Matrix3d::Zero());
  for (int row = 0; row < 3; ++row)
    for (int column = row; column < 3; ++column) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
      m(row, column) = 1e-300;
      EXPECT_FALSE(Symmetric3(m).isZero());
    }
}

}  // namespace
}  // namespace slam::core
