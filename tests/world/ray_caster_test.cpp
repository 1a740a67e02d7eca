#include "libslam/world/ray_caster.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "drawn_plan.h"
#include "libslam/core/random.h"

namespace slam::world {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
using core::kPi;

const Plan& room() {
  static const Plan plan = drawnPlan({"########",  //
                                      "#......#",  //
                                      "#......#",  //
                                      "#..##..#",  //
                                      "#......#",  //
                                      "########"});
  return plan;
}

/// A quarter of the cells are walls, the rim is open.
Plan scatteredPlan(int columns, int rows, std::uint64_t seed, int one_in) {
  Plan plan;
  plan.columns = columns;
  plan.rows = rows;
  plan.resolution_m = 0.05;
  core::RandomStream random(seed, "scattered plan");
  for (int i = 0; i < columns * rows; ++i)
    plan.cells.push_back(random.below(static_cast<std::uint64_t>(one_in)) == 0 ? Cell::kOccupied
                                                                               : Cell::kFree);
  return plan;
}

TEST(RayCaster, MeasuresToTheFaceOfAWallAndNotToItsCentre) {
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, 0, 0), 5.5);
  // cos(pi/2) is 6e-17 and not 0, too little to move these hits by a bit.
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, kPi / 2, 0), 3.5);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, kPi, 0), 0.5);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, -kPi / 2, 0), 0.5);
  EXPECT_EQ(castRay(room(), {1.25, 2.75}, 0, 0), 1.75) << "the block in the middle";
}

TEST(RayCaster, MeasuresAlongADiagonal) {
  // From (1.25, 1.5) at 45 degrees the ray enters the block's cell (3, 2) through its left face at x = 3? No:
  // at x = 2.75 it is at y = 3, above row 2, and goes on to the ceiling at y = 5.
  EXPECT_NEAR(castRay(room(), {1.25, 1.5}, kPi / 4, 0), 3.5 * std::sqrt(2.0), 1e-14);
  // From (1.75, 1.5) it is at y = 2.75 when it meets the face x = 3.
  EXPECT_NEAR(castRay(room(), {1.75, 1.5}, kPi / 4, 0), 1.25 * std::sqrt(2.0), 1e-14);
  // 4-3-5 triangle: 4 to the right, 3 up, onto the ceiling at (5.5, 5).
  EXPECT_NEAR(castRay(room(), {5.5 - 4, 5 - 3.0}, std::atan2(3.0, 4.0), 0), (3 - 1.5) * 5 / 4, 1e-14)
      << "stopped by the block's face x = 3 at y = 3.125? no, at 2.x";
}

TEST(RayCaster, ReturnsZeroInsideAWall) {
  EXPECT_EQ(castRay(room(), {3.5, 2.5}, 0.3, 0), 0);
  EXPECT_EQ(castRay(room(), {0.5, 0.5}, kPi, 5), 0);
}

TEST(RayCaster, ReturnsInfinityAtTheEdgeOfThePlan) {
  const Plan open = drawnPlan({"...", "...", "..."});
  for (int i = 0; i < 100; ++i) EXPECT_EQ(castRay(open, {1.5, 1.5}, 0.0628 * i, 0), kInfinity);
}

TEST(RayCaster, SeesThroughUnknownCells) {
  EXPECT_EQ(castRay(drawnPlan({".??#"}), {0.5, 0.5}, 0, 0), 2.5);
}

TEST(RayCaster, StopsAtTheMaximumRangeInclusive) {
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, 0, 5.5), 5.5);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, 0, std::nextafter(5.5, 0.0)), kInfinity);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, 0, 0), 5.5) << "0: no limit";
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, 0, -1), 5.5);
}

TEST(RayCaster, AnswersInfinityForAPoseThatIsNotFiniteOrOutside) {
  for (const double bad : {kNaN, kInfinity, -kInfinity, 1e300, -0.5, 8.5}) {
    EXPECT_EQ(castRay(room(), {bad, 1.5}, 0, 0), kInfinity) << bad;
    EXPECT_EQ(castRay(room(), {1.5, bad}, 0, 0), kInfinity) << bad;
  }
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, kNaN, 0), kInfinity);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, kInfinity, 0), kInfinity);
  EXPECT_EQ(castRay(Plan{}, {0, 0}, 0, 0), kInfinity) << "a plan without cells";
}

}  // namespace
}  // namespace slam::world
