#include "libslam/rays/ray_caster.h"
#include "libslam/core/numbers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <utility>

#include "libslam/core/random.h"
#include "tests/world/drawn_plan.h"

namespace slam::rays {
namespace {

using core::kInfinity;
using core::kNaN;
using core::kPi;

const world::Plan& room() {
  static const world::Plan plan = world::drawnPlan({"########",  //
                                                    "#......#",  //
                                                    "#......#",  //
                                                    "#..##..#",  //
                                                    "#......#",  //
                                                    "########"});
  return plan;
}

/// An origin and a unit vector without libm's sine, so that its bits are the same on every machine.
struct Ray {
  core::Point2 origin, direction;
};
Ray randomRay(core::RandomStream& random, const world::Plan& plan) {
  Ray ray;
  ray.origin = {random.uniform(0, plan.columns), random.uniform(0, plan.rows)};
  double x = 0, y = 0, norm2 = 0;
  while (norm2 < 0.01 || norm2 > 1) {
    x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    norm2 = x * x + y * y;
  }
  ray.direction = {x / std::sqrt(norm2), y / std::sqrt(norm2)};
  return ray;
}

/// The plain walk (Amanatides and Woo, Eurographics 1987): step into whichever neighbour the ray reaches
/// first, keeping the travelled distance per axis.
double plainWalk(const world::Plan& plan, const Ray& ray) {
  int column = static_cast<int>(std::floor(ray.origin.x)), row = static_cast<int>(std::floor(ray.origin.y));
  const auto distanceToLine = [](double origin, double direction, int line) {
    return direction == 0 ? kInfinity : (line - origin) / direction;
  };
  double entered = 0;
  while (plan.contains(column, row)) {
    if (plan.at(column, row) == world::Cell::kOccupied) return entered;
    const double to_column = distanceToLine(ray.origin.x, ray.direction.x, column + (ray.direction.x > 0));
    const double to_row = distanceToLine(ray.origin.y, ray.direction.y, row + (ray.direction.y > 0));
    entered = std::min(to_column, to_row);
    if (to_column < to_row)
      column += ray.direction.x > 0 ? 1 : -1;
    else
      row += ray.direction.y > 0 ? 1 : -1;
  }
  return kInfinity;
}

/// True when the ray passes a lattice corner within `tolerance` cells before `length`.
bool passesCorner(const Ray& ray, double length, double tolerance) {
  const bool x_major = std::abs(ray.direction.x) >= std::abs(ray.direction.y);
  const double ou = x_major ? ray.origin.x : ray.origin.y, ov = x_major ? ray.origin.y : ray.origin.x;
  const double du = x_major ? ray.direction.x : ray.direction.y;
  const double dv = x_major ? ray.direction.y : ray.direction.x;
  const double end = ou + du * (length + 2);
  const int last = static_cast<int>(std::ceil(std::max(ou, end)));
  for (int u = static_cast<int>(std::floor(std::min(ou, end))); u <= last; ++u) {
    const double v = ov + (u - ou) / du * dv;
    if (std::abs(v - std::round(v)) < tolerance) return true;
  }
  return false;
}

bool sameRange(double a, double b, double tolerance) {
  return a == b || std::abs(a - b) <= tolerance;
}

TEST(RayCaster, MeasuresToTheFaceOfAWallAndNotToItsCentre) {
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, 0, 0), 5.5);
  // cos(pi/2) is 6e-17 and not 0, too little to move these hits by a bit.
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, kPi / 2, 0), 3.5);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, kPi, 0), 0.5);
  EXPECT_EQ(castRay(room(), {1.5, 1.5}, -kPi / 2, 0), 0.5);
  EXPECT_EQ(castRay(room(), {1.25, 2.75}, 0, 0), 1.75) << "the block in the middle";
}

TEST(RayCaster, MeasuresAlongASlope) {
  const double root2 = std::sqrt(2.0), tolerance = 1e-14;  // a few roundings of numbers below 8
  // 45 degrees: over the block (y = 3.25 at x = 3) to the ceiling y = 5; into the block's face x = 3.
  EXPECT_NEAR(castRay(room(), {1.25, 1.5}, kPi / 4, 0), 3.5 * root2, tolerance);
  EXPECT_NEAR(castRay(room(), {1.75, 1.5}, kPi / 4, 0), 1.25 * root2, tolerance);
  // The 3-4-5 triangle: into the face x = 3 at y = 2.625; over the block to the ceiling.
  EXPECT_NEAR(castRay(room(), {1.5, 1.5}, std::atan2(3.0, 4.0), 0), 1.5 * 5 / 4, tolerance);
  EXPECT_NEAR(castRay(room(), {1.5, 2.5}, std::atan2(3.0, 4.0), 0), 2.5 * 5 / 3, tolerance);
  // The same from above, mirrored: down and left onto the block's top y = 3.
  EXPECT_NEAR(castRay(room(), {6.0, 4.5}, std::atan2(-3.0, -4.0), 0), 1.5 * 5 / 3, tolerance);
}

TEST(RayCaster, LetsItsRuleDecideARayThroughACorner) {
  // cos(pi/4) >= sin(pi/4): x is major, the walk enters the right neighbour and never the upper one.
  EXPECT_EQ(castRay(world::drawnPlan({"#..", "...", "..."}), {0.5, 1.5}, kPi / 4, 0), kInfinity);
  EXPECT_NEAR(castRay(world::drawnPlan({"...", ".#.", "..."}), {0.5, 1.5}, kPi / 4, 0), std::sqrt(0.5),
              1e-15);
}

TEST(RayCaster, EntersTheUpperNeighbourWhereTheRowIsReachedExactlyAtAColumn) {
  // Slope 1/2 from (0.5, 0.75): through the corner (1, 1) exactly, by way of (0, 1) and not of (1, 0).
  const core::Point2 direction{2 / std::sqrt(5.0), 1 / std::sqrt(5.0)};
  EXPECT_NEAR(castRayInCells(world::drawnPlan({"#..", "..."}), {0.5, 0.75}, direction), 0.25 * std::sqrt(5.0),
              1e-15);
  EXPECT_EQ(castRayInCells(world::drawnPlan({"...", ".##"}), {0.5, 0.75}, direction), kInfinity);
}

TEST(RayCaster, CountsAnOriginOnAGridLineToTheCellAhead) {
  const world::Plan plan = world::drawnPlan({"..#.."});
  EXPECT_EQ(castRayInCells(plan, {2, 0.5}, {1, 0}), 0);
  EXPECT_EQ(castRayInCells(plan, {2, 0.5}, {-1, 0}), kInfinity);
  EXPECT_EQ(castRayInCells(plan, {3, 0.5}, {-1, 0}), 0);
  EXPECT_EQ(castRayInCells(plan, {3, 0.5}, {1, 0}), kInfinity);
  EXPECT_EQ(castRayInCells(plan, {5, 0.5}, {-1, 0}), 2) << "from the plan's very edge";
  EXPECT_EQ(castRayInCells(plan, {5, 0.5}, {1, 0}), kInfinity);
}

TEST(RayCaster, ReturnsZeroInsideAWall) {
  EXPECT_EQ(castRay(room(), {3.5, 2.5}, 0.3, 0), 0);
  EXPECT_EQ(castRay(room(), {0.5, 0.5}, kPi, 5), 0);
}

TEST(RayCaster, ReturnsInfinityAtTheEdgeOfThePlan) {
  const world::Plan open = world::drawnPlan({"...", "...", "..."});
  for (int i = 0; i < 100; ++i) EXPECT_EQ(castRay(open, {1.5, 1.5}, 0.0628 * i, 0), kInfinity);
}

TEST(RayCaster, SeesThroughUnknownCells) {
  EXPECT_EQ(castRay(world::drawnPlan({".??#"}), {0.5, 0.5}, 0, 0), 2.5);
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
  EXPECT_EQ(castRay(world::Plan{}, {0, 0}, 0, 0), kInfinity) << "a plan without cells";
}

TEST(RayCaster, AgreesWithThePlainWalkExceptThroughCorners) {
  int rays = 0, ties = 0, hits = 0;
  for (const int one_in : {8, 60, 1000}) {
    const world::Plan plan = world::scatteredPlan(150, 110, 7, one_in);
    core::RandomStream random(11, "oracle");
    for (int i = 0; i < 80000; ++i, ++rays) {
      const Ray ray = randomRay(random, plan);
      const double ours = castRayInCells(plan, ray.origin, ray.direction), plain = plainWalk(plan, ray);
      hits += ours < kInfinity;
      // Both divide one coordinate difference, below 150, by one direction component; only which of two
      // nearly equal crossings is named differs.
      if (sameRange(ours, plain, 1e-10)) continue;
      ++ties;
      EXPECT_TRUE(passesCorner(ray, std::min({ours, plain, 300.0}), 1e-8)) << ours << " and " << plain;
    }
  }
  EXPECT_EQ(rays, 240000);
  EXPECT_GT(hits, 120000);
  EXPECT_LE(ties, 2) << "a random ray meets a corner within 1e-8 cells about once in 10^6";
}

TEST(RayCaster, DiffersFromThePlainWalkOnlyAtCornersOnRationalRays) {
  const world::Plan plan = world::scatteredPlan(64, 64, 3, 20);
  core::RandomStream random(5, "rational rays");
  int ties = 0;
  const int rays = 40000;
  for (int i = 0; i < rays; ++i) {
    Ray ray;
    // Never on a grid line, where the plain walk has its own idea of the first cell.
    ray.origin = {static_cast<double>(random.below(64)) + 0.25 * static_cast<double>(1 + random.below(3)),
                  static_cast<double>(random.below(64)) + 0.25 * static_cast<double>(1 + random.below(3))};
    const double x = static_cast<double>(random.below(9)) - 4, y = static_cast<double>(random.below(9)) - 4;
    if (x == 0 && y == 0) continue;
    ray.direction = {x / std::hypot(x, y), y / std::hypot(x, y)};
    const double ours = castRayInCells(plan, ray.origin, ray.direction), plain = plainWalk(plan, ray);
    if (sameRange(ours, plain, 1e-10)) continue;
    ++ties;
    EXPECT_TRUE(passesCorner(ray, std::min({ours, plain, 100.0}), 1e-8)) << ours << " and " << plain;
  }
  EXPECT_GT(ties, 0) << "such rays do meet corners";
  EXPECT_LT(ties, rays / 10);
}

/// One of the eight images of the square: mirror in x, mirror in y, swap the axes.
struct Symmetry {
  bool mirror_x, mirror_y, swap;

  world::Plan operator()(const world::Plan& plan) const {
    world::Plan image = plan;
    if (swap) std::swap(image.columns, image.rows);
    for (int row = 0; row < plan.rows; ++row)
      for (int column = 0; column < plan.columns; ++column) {
        int c = mirror_x ? plan.columns - 1 - column : column, r = mirror_y ? plan.rows - 1 - row : row;
        if (swap) std::swap(c, r);
        image.cells[static_cast<size_t>(r) * image.columns + c] = plan.at(column, row);
      }
    return image;
  }
  Ray operator()(const Ray& ray, const world::Plan& plan) const {
    Ray image = ray;
    if (mirror_x) image.origin.x = plan.columns - ray.origin.x, image.direction.x = -ray.direction.x;
    if (mirror_y) image.origin.y = plan.rows - ray.origin.y, image.direction.y = -ray.direction.y;
    if (swap) std::swap(image.origin.x, image.origin.y), std::swap(image.direction.x, image.direction.y);
    return image;
  }
};

TEST(RayCaster, GivesTheSameBitsInTheEightImagesOfAPlan) {
  const world::Plan plan = world::scatteredPlan(120, 90, 21, 80);
  for (int image = 1; image < 8; ++image) {
    const Symmetry symmetry{(image & 1) != 0, (image & 2) != 0, (image & 4) != 0};
    const world::Plan image_plan = symmetry(plan);
    core::RandomStream random(33, "symmetry");
    for (int i = 0; i < 5000; ++i) {
      Ray ray = randomRay(random, plan);
      // On a grid of 2^-20 cells the mirrored origin is exact; the direction has all its bits.
      ray.origin = {std::floor(ray.origin.x * 0x1p20) * 0x1p-20, std::floor(ray.origin.y * 0x1p20) * 0x1p-20};
      const Ray mirrored = symmetry(ray, plan);
      ASSERT_EQ(castRayInCells(plan, ray.origin, ray.direction),
                castRayInCells(image_plan, mirrored.origin, mirrored.direction))
          << "image " << image << ", ray " << i;
    }
  }
}

TEST(RayCaster, EndsEveryAxisAlignedRayOnAGridLine) {
  const world::Plan plan = world::scatteredPlan(40, 30, 2, 30);
  for (int column = 0; column <= plan.columns; ++column)
    for (int row = 0; row <= plan.rows; ++row)
      for (const core::Point2 direction :
           {core::Point2{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -0.0}, {-0.0, 1}}) {
        const double range =
            castRayInCells(plan, {static_cast<double>(column), static_cast<double>(row)}, direction);
        EXPECT_TRUE(range == kInfinity || (range >= 0 && range == std::floor(range) && range <= 40)) << range;
      }
}

TEST(RayCaster, KeepsTheHitInItsColumnOnAnAlmostParallelRay) {
  // One rounding step below the wall y = 2, with the slope of cos(pi/2): row(3) rounds to 2, so the walk
  // enters the wall in column 2, while the line through the same numbers meets y = 2 only at x = 4.2.
  const world::Plan plan = world::drawnPlan({"############", "............", "............"});
  EXPECT_EQ(castRayInCells(plan, {0.5, std::nextafter(2.0, 0.0)}, {1, 6e-17}), 2.5);
}

TEST(RayCaster, TurnsAndShiftsWithThePlan) {
  world::Plan placed = world::scatteredPlan(90, 120, 4, 50);
  const world::Plan still = placed;
  core::RandomStream random(8, "placed");
  int ties = 0;
  for (int i = 0; i < 20000; ++i) {
    placed.T_frame_raster = {random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-4, 4)};
    const core::Point2 p_plan{random.uniform(0, 4.5), random.uniform(0, 6)};
    const double angle_rad = random.uniform(-kPi, kPi);
    const double expected = castRay(still, p_plan, angle_rad, 3);
    const double found =
        castRay(placed, placed.T_frame_raster * p_plan, angle_rad + placed.T_frame_raster.phi, 3);
    // 1e-14 of rounding in a coordinate of 50 m, stretched where a ray grazes a face.
    ties += !sameRange(expected, found, 1e-9);
  }
  EXPECT_LE(ties, 2) << "rays within 1e-13 of a corner or of the maximum range";

  placed = room();
  placed.T_frame_raster = {10, -5, kPi / 2};  // the plan's x axis points along the world's y axis
  EXPECT_NEAR(castRay(placed, {10 - 1.5, -5 + 1.5}, kPi / 2, 0), 5.5, 1e-12);
  EXPECT_NEAR(castRay(placed, {10 - 1.5, -5 + 1.5}, kPi, 0), 3.5, 1e-12);
}

TEST(RayCaster, CastsAScanBeamByBeam) {
  world::Plan plan = world::scatteredPlan(100, 100, 6, 40);
  plan.T_frame_raster = {-1, 2, 0.3};
  const core::Pose2 T_world_lidar{0.5, 4.5, 1.2};
  std::vector<float> ranges(3, -1.0F);
  castScan(plan, T_world_lidar, {-2, 0.01, 400}, 1.5, ranges);
  ASSERT_EQ(ranges.size(), 400U);
  // The turned direction differs from the one along the summed angle by a rounding.
  for (int i = 0; i < 400; ++i) {
    const double alone = castRay(plan, {0.5, 4.5}, 1.2 + -2 + i * 0.01, 1.5);
    if (std::isfinite(alone))
      EXPECT_NEAR(ranges[i], alone, 1e-6) << i;
    else
      EXPECT_FALSE(std::isfinite(ranges[i])) << i;
  }
  castScan(plan, T_world_lidar, {-2, 0.01, 0}, 0, ranges);
  EXPECT_TRUE(ranges.empty());
  castScan(plan, {kNaN, 0, 0}, {-2, 0.01, 2}, 0, ranges);
  EXPECT_EQ(ranges, std::vector<float>(2, std::numeric_limits<float>::infinity()));
}

TEST(RayCaster, GivesTheSameBitsInEveryBuild) {
  const world::Plan plan = world::scatteredPlan(300, 200, 1, 200);
  core::RandomStream random(1, "golden");
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a over the bits of 20000 ranges
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = randomRay(random, plan);
    const double range = castRayInCells(plan, ray.origin, ray.direction);
    std::uint64_t bits = 0;
    std::memcpy(&bits, &range, sizeof bits);
    hash = (hash ^ bits) * 0x100000001b3ULL;
  }
  EXPECT_EQ(hash, 0x28f01403b28aced6ULL) << std::hex << hash;
}

}  // namespace
}  // namespace slam::rays
