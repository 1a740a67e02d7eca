#include <gtest/gtest.h>

#include <cmath>

#include "libslam/gridmap/grid.h"

namespace slam::gridmap {
namespace {

TEST(Side, TellsDirectionsApartByTwelveDegrees) {
  for (int degrees = 0; degrees < 360; ++degrees) {
    const core::Point2 p{std::cos(core::degToRad(degrees)), std::sin(core::degToRad(degrees))};
    EXPECT_GT(cosine(sideTowards({3 * p.x, 3 * p.y}), p.x, p.y), std::cos(core::degToRad(12.01))) << degrees;
  }
  EXPECT_EQ(sideTowards({0, 0}), kNoSide);
  EXPECT_EQ(cosine(kNoSide, 1, 0), 0);
}

// Both faces of a thin wall in one cell.
TEST(Grid, ReturnsFromTheOtherSideLeaveASurfaceInPlace) {
  Grid grid({});  // cells of 0.05 m
  const auto insert = [&grid](double from_x, double x, const core::Point2& normal) {
    grid.insert({{from_x, 0.01}, {{{x, 0.01}, true, normal}}}, {});
    return *grid.at(40, 0);
  };
  const Cell front = insert(0, 2.01, {-0.1, 0.02});
  EXPECT_EQ(front.side(), sideTowards({-1, 0}));
  const Cell from_behind = insert(4, 2.04, {0.1, -0.02});
  EXPECT_EQ(from_behind.shift_x, front.shift_x);
  EXPECT_EQ(from_behind.side(), front.side());
  EXPECT_GT(from_behind.log_odds, front.log_odds);
  EXPECT_GT(insert(0, 2.04, {-1, 0}).shift_x, front.shift_x);
  EXPECT_GT(insert(4, 2.049, {0, 0}).shift_x, insert(0, 2.01, {-1, 0}).shift_x);  // of no side
  EXPECT_EQ(grid.at(42, 1)->side(), front.side());                                // told around it
}

// The robot's heading turns the normals, too.
TEST(Grid, KnowsTheSideInTheMapFrame) {
  Grid grid({});
  grid.insert({{0, 0}, {{{2.01, 0}, true, {-1, 0}}}}, {0, 0, core::kPi / 2});
  EXPECT_EQ(grid.at(0, 40)->side(), sideTowards({0, -1}));
}

}  // namespace
}  // namespace slam::gridmap
