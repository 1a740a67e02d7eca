#include "libslam/core/plane_cell.h"

#include <gtest/gtest.h>

#include "libslam/core/numbers.h"

namespace slam::core {
namespace {

TEST(PlaneCell, IsOneNumberPerCellOnBothSidesOfTheOrigin) {
  EXPECT_EQ(planeCell({0.1, 0.1}, 0.2), 0);
  EXPECT_EQ(planeCell({0.5, 0.1}, 0.2), 2);
  EXPECT_EQ(planeCell({-0.1, 0.1}, 0.2), -1);
  EXPECT_EQ(planeCell({0.1, 0.5}, 0.2), PlaneCell{2} << 32);
  EXPECT_EQ(planeCell({-0.1, 0.5}, 0.2), (PlaneCell{2} << 32) - 1);
  EXPECT_EQ(planeCell({0.1, -0.5}, 0.2), -(PlaneCell{3} << 32));
}

TEST(PlaneCell, OfWhatIsBeyondAnyMapIsTheLastOne) {
  constexpr PlaneCell kMost = PlaneCell{1} << 30;
  EXPECT_EQ(cellOnLine(1e38), kMost);
  EXPECT_EQ(cellOnLine(-1e38), -kMost);
  EXPECT_EQ(cellOnLine(kInfinity), kMost);
  EXPECT_EQ(cellOnLine(kNaN), -kMost);
  EXPECT_EQ(cellOnLine(1e9), 1000000000);
}

}  // namespace
}  // namespace slam::core
