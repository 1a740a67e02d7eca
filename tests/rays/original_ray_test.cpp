#include "libslam/rays/original_ray.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"
#include "tests/world/drawn_plan.h"

namespace slam::rays {
namespace {

using core::degToRad;
using core::kInfinity;
using core::kPi;

double castDegrees(const world::Plan& plan, const core::Point2& origin, double angle_deg,
                   double max_range_m = 0) {
  return castOriginalRay(plan, origin, degToRad(angle_deg), max_range_m);
}

/// As the original document tells it and in whole pixels only: all pixels of the line to a very far point.
double castByTheDocument(const world::Plan& plan, const core::Point2& origin, double angle_rad) {
  const int x0 = static_cast<int>(std::floor(origin.x / plan.resolution_m));
  const int y0 = static_cast<int>(std::floor(origin.y / plan.resolution_m));
  const double far_x = 1e7 * std::cos(angle_rad), far_y = 1e7 * std::sin(angle_rad);
  const double longer = std::max(std::abs(far_x), std::abs(far_y));
  for (int step = 0;; ++step) {
    const double dx = step * far_x / longer, dy = step * far_y / longer;
    const auto nearest = [](double v) { return static_cast<int>(v < 0 ? v - 0.5 : v + 0.5); };
    const int x = x0 + nearest(dx), y = y0 + nearest(dy);
    if (!plan.contains(x, y)) return kInfinity;
    if (plan.at(x, y) != world::Cell::kOccupied) continue;
    return std::floor(std::hypot(x - x0, y - y0) + 0.5) * plan.resolution_m;
  }
}

TEST(OriginalRays, MeasureFromPixelToPixelInWholePixels) {
  const world::Plan plan =
      world::drawnPlan({"......#", ".......", ".......", "....#..", ".......", ".......", "#......"});
  // From the pixel (0, 3): the wall is in (4, 3), its face 3.9 before the place within the pixel.
  EXPECT_EQ(castDegrees(plan, {0.1, 3.9}, 0), 4);
  EXPECT_EQ(castDegrees(plan, {0.9, 3.1}, 0), 4) << "wherever in the pixel the ray begins";
  EXPECT_EQ(castDegrees(plan, {0.5, 3.5}, -90), 3);
  // Along the diagonal to (6, 6) from (3, 3): 3 steps, 4.24 pixels.
  EXPECT_EQ(castDegrees(plan, {3.5, 3.5}, 45), 4);
  EXPECT_EQ(castDegrees(plan, {3.5, 3.5}, -135), 4);
}

TEST(OriginalRays, TakeTheNearestPixelOfTheOtherAxis) {
  const world::Plan plan = world::drawnPlan({".....", "..#..", "....."});
  // Two columns ahead the line stands 2 tan(a) above the middle of row 0: from 0.5 on the nearest row is 1.
  const double half_rad = std::atan2(0.5, 2);
  EXPECT_EQ(castOriginalRay(plan, {0.5, 0.5}, half_rad + 0.001, 0), 2) << "2.24 pixels";
  EXPECT_EQ(castOriginalRay(plan, {0.5, 0.5}, half_rad - 0.001, 0), kInfinity);
}

TEST(OriginalRays, StepOverTheCornerBetweenTwoPixels) {
  const world::Plan plan = world::drawnPlan({"...#", "..#.", ".#..", "#..."});
  EXPECT_EQ(castDegrees(plan, {0.5, 3.5}, -45), kInfinity) << "through the wall, from pixel to pixel";
  const world::Plan even = world::drawnPlan({"..#.", ".#..", "#...", "...."});
  EXPECT_EQ(castDegrees(even, {0.5, 3.5}, -45), 1) << "(1, 2) is on the line";
}

TEST(OriginalRays, EndWhereTheExactOnesDo) {
  const world::Plan plan = world::drawnPlan({"....", ".?.#", "...."}, 0.5);
  EXPECT_EQ(castDegrees(plan, {0.25, 0.75}, 0), 1.5) << "the unknown is transparent; 3 pixels of 0.5 m";
  EXPECT_EQ(castDegrees(plan, {0.25, 0.75}, 0, 1.5), 1.5);
  EXPECT_EQ(castDegrees(plan, {0.25, 0.75}, 0, 1.4), kInfinity);
  EXPECT_EQ(castDegrees(plan, {0.25, 0.75}, 90), kInfinity) << "out of the picture";
  EXPECT_EQ(castDegrees(plan, {1.75, 0.75}, 0), 0) << "in a wall";
  EXPECT_EQ(castDegrees(plan, {-0.1, 0.75}, 0), kInfinity);
  EXPECT_EQ(castDegrees(plan, {std::nan(""), 0.75}, 0), kInfinity);
  EXPECT_EQ(castOriginalRay(plan, {0.25, 0.75}, std::nan(""), 0), kInfinity);
}

TEST(OriginalRays, EqualTheWalkAlongAllPixelsOfTheLine) {
  const world::Plan plan = world::scatteredPlan(61, 47, 3, 40);
  core::RandomStream random(5, "origins");
  for (int i = 0; i < 200; ++i) {
    const core::Point2 origin{random.uniform(0, 61 * 0.05), random.uniform(0, 47 * 0.05)};
    for (int degree = 0; degree < 360; ++degree)
      ASSERT_EQ(castOriginalRay(plan, origin, degToRad(degree), 0),
                castByTheDocument(plan, origin, degToRad(degree)))
          << origin.x << " " << origin.y << " " << degree;
  }
}

TEST(OriginalRays, AreHalfAPixelAcrossLongerThanExactOnes) {
  // A room whose walls cross the longer axis of every ray, from its middle pixel: 0.5 / max(|cos|, |sin|)
  // more before the rounding to whole pixels, and that has no bias over many directions. Mean over the
  // circle: 2 / pi asinh(1) = 0.561.
  constexpr int kSide = 801;
  std::vector<std::string> lines(kSide, "#" + std::string(kSide - 2, '.') + "#");
  lines.front() = lines.back() = std::string(kSide, '#');
  const world::Plan plan = world::drawnPlan(lines);
  const core::Point2 middle{kSide / 2.0, kSide / 2.0};
  double sum = 0;
  constexpr int kRays = 3600;
  for (int i = 0; i < kRays; ++i) {
    const double angle_rad = (i + 0.5) * 2 * kPi / kRays;
    sum += castOriginalRay(plan, middle, angle_rad, 0) - castRay(plan, middle, angle_rad, 0);
  }
  // Rounding adds at most 0.29 / sqrt(directions that differ), 0.29 / sqrt(3600 / 8) = 0.014.
  EXPECT_NEAR(sum / kRays, 2 / kPi * std::asinh(1.0), 0.03);
}

}  // namespace
}  // namespace slam::rays
