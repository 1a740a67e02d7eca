#include "libslam/mrptworld/grid_caster.h"

#include <gtest/gtest.h>
#include <mrpt/random/RandomGenerators.h>

#include <cmath>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/rays/ray_caster.h"

namespace slam::mrptworld {
namespace {

using mrpt::maps::COccupancyGridMap2D;
using mrpt::obs::CObservation2DRangeScan;

/// 10 x 8 m at (-3, 2): walls round it, blocks inside, and cells that nobody has seen.
COccupancyGridMap2D someGrid(bool with_unknown) {
  COccupancyGridMap2D grid(-3, 7, 2, 10, 0.1F);
  core::RandomStream random(1, "grid");
  const int columns = static_cast<int>(grid.getSizeX()), rows = static_cast<int>(grid.getSizeY());
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < columns; ++x) {
      const bool rim = x == 0 || y == 0 || x == columns - 1 || y == rows - 1;
      grid.setCell(x, y, rim ? 0.05F : 0.95F);
    }
  for (int i = 0; i < 12; ++i) {
    const int x0 = static_cast<int>(random.below(90)), y0 = static_cast<int>(random.below(70));
    for (int y = y0; y < y0 + 6; ++y)
      for (int x = x0; x < x0 + 6; ++x) grid.setCell(x, y, 0.05F);
  }
  if (with_unknown)
    for (int y = 20; y < 40; ++y)
      for (int x = 60; x < 64; ++x) grid.setCell(x, y, 0.5F);
  return grid;
}

CObservation2DRangeScan someScan() {
  CObservation2DRangeScan scan;
  scan.aperture = 4.5F;
  scan.maxRange = 20;
  scan.sensorPose = mrpt::poses::CPose3D(0.2, -0.1, 0.3, 0.4, 0, 0);
  return scan;
}

TEST(GridCaster, GivesTheExactRangesOfThePlan) {
  const auto grid = someGrid(false);
  const GridCaster caster(grid);
  auto scan = someScan();
  const mrpt::poses::CPose2D robot(1.03, 5.17, 0.7);
  caster.laserScanSimulator(scan, robot, 271);
  const auto sensor = robot + mrpt::poses::CPose2D(scan.sensorPose);
  int returns = 0;
  for (size_t i = 0; i < 271; ++i) {
    const double angle_rad =
        sensor.phi() - scan.aperture / 2.0 + static_cast<double>(i) * scan.aperture / 270.0;
    const double expected = rays::castRay(caster.plan(), {sensor.x(), sensor.y()}, angle_rad, 0);
    ASSERT_EQ(scan.getScanRangeValidity(i), std::isfinite(expected)) << i;
    if (!std::isfinite(expected)) continue;
    EXPECT_NEAR(scan.getScanRange(i), expected, 1e-6) << i;
    ++returns;
  }
  EXPECT_EQ(returns, 271);
}

// A drop-in replacement: with the same arguments MRPT's own is the same to the step of its march, but where
// it stepped over a corner.
TEST(GridCaster, AgreesWithMrptToItsStep) {
  for (const bool with_unknown : {false, true})
    for (const bool right_to_left : {true, false})
      for (const float threshold : {0.5F, 0.6F}) {
        const auto grid = someGrid(with_unknown);
        const GridCaster caster(grid, threshold);
        auto ours = someScan(), theirs = someScan();
        ours.rightToLeft = theirs.rightToLeft = right_to_left;
        int agree = 0, all = 0, returns = 0;
        core::RandomStream random(3, "poses");
        for (int k = 0; k < 40; ++k) {
          const mrpt::poses::CPose2D robot(random.uniform(-2, 6), random.uniform(3, 9),
                                           random.uniform(-3, 3));
          const auto sensor = robot + mrpt::poses::CPose2D(ours.sensorPose);
          if (grid.getPos(static_cast<float>(sensor.x()), static_cast<float>(sensor.y())) < 0.6F) continue;
          caster.laserScanSimulator(ours, robot, 181);
          grid.laserScanSimulator(theirs, robot, threshold, 181, 0);
          for (size_t i = 0; i < 181; ++i, ++all) {
            const bool same = ours.getScanRangeValidity(i) == theirs.getScanRangeValidity(i);
            const double difference = std::abs(ours.getScanRange(i) - theirs.getScanRange(i));
            agree += same && difference < 0.11;
            returns += ours.getScanRangeValidity(i);
          }
        }
        ASSERT_GT(all, 4000);
        EXPECT_GT(agree, all * 97 / 100) << with_unknown << right_to_left << threshold << " of " << all;
        EXPECT_EQ(returns < all, with_unknown && threshold == 0.5F);
      }
}

// MRPT's reports a wall at 9 m as no return to a lidar of 10 m.
TEST(GridCaster, SeesUpToTheMaximumRange) {
  COccupancyGridMap2D grid(0, 12, 0, 1, 0.1F);
  grid.fill(0.95F);
  for (int y = 0; y < 10; ++y) grid.setCell(95, y, 0.05F);
  const GridCaster caster(grid);
  CObservation2DRangeScan scan;
  scan.aperture = 0.02F;
  for (const float max_range_m : {9.1F, 8.9F}) {
    scan.maxRange = max_range_m;
    caster.laserScanSimulator(scan, {0.5, 0.55, 0}, 3);
    EXPECT_EQ(scan.getScanRangeValidity(1), max_range_m > 9);
    EXPECT_NEAR(scan.getScanRange(1), max_range_m > 9 ? 9.0F : max_range_m, 1e-5);
  }
  scan.maxRange = 10;
  grid.laserScanSimulator(scan, {0.5, 0.55, 0}, 0.6F, 3);
  EXPECT_FALSE(scan.getScanRangeValidity(1));
}

TEST(GridCaster, CastsOneRayNoneOrEveryOther) {
  const auto grid = someGrid(false);
  const GridCaster caster(grid);
  auto scan = someScan();
  caster.laserScanSimulator(scan, {1, 5, 0}, 0);
  EXPECT_EQ(scan.getScanSize(), 0U);
  caster.laserScanSimulator(scan, {1, 5, 0}, 1);
  EXPECT_EQ(scan.getScanSize(), 1U);
  caster.laserScanSimulator(scan, {1, 5, 0}, 5, 0, 2);
  EXPECT_TRUE(scan.getScanRangeValidity(0) && scan.getScanRangeValidity(2) && scan.getScanRangeValidity(4));
  EXPECT_FALSE(scan.getScanRangeValidity(1) || scan.getScanRangeValidity(3));
}

TEST(GridCaster, DrawsNoiseAsMrptDoes) {
  const auto grid = someGrid(false);
  const GridCaster caster(grid);
  auto exact = someScan(), noisy = someScan();
  caster.laserScanSimulator(exact, {1, 5, 0}, 1000);
  mrpt::random::getRandomGenerator().randomize(5);
  caster.laserScanSimulator(noisy, {1, 5, 0}, 1000, 0.05F);
  double sum = 0, squares = 0;
  for (size_t i = 0; i < 1000; ++i) {
    const double error = noisy.getScanRange(i) - exact.getScanRange(i);
    sum += error;
    squares += error * error;
  }
  EXPECT_NEAR(sum / 1000, 0, 5 * 0.05 / std::sqrt(1000.0));  // five sigmas of the mean
  EXPECT_NEAR(std::sqrt(squares / 1000), 0.05, 5 * 0.05 / std::sqrt(2000.0));
  caster.laserScanSimulator(noisy, {1, 5, 0}, 1000, 0, 1, 0.01F);
  int moved = 0;
  for (size_t i = 0; i < 1000; ++i) moved += noisy.getScanRange(i) != exact.getScanRange(i);
  EXPECT_GT(moved, 900);
}

TEST(GridCaster, FollowsAChangeOfTheGrid) {
  for (const float threshold : {0.5F, 0.6F}) {
    auto grid = someGrid(true);
    GridCaster caster(grid, threshold);
    for (int y = 30; y < 33; ++y)
      for (int x = 40; x < 50; ++x) grid.setCell(x, y, 0.02F);
    caster.update(grid, 40, 30, 50, 33);
    const GridCaster fresh(grid, threshold);
    auto ours = someScan(), expected = someScan();
    caster.laserScanSimulator(ours, {1.1, 4, -0.5}, 361);
    fresh.laserScanSimulator(expected, {1.1, 4, -0.5}, 361);
    for (size_t i = 0; i < 361; ++i) EXPECT_EQ(ours.getScanRange(i), expected.getScanRange(i)) << i;
  }
  auto grid = someGrid(false);
  GridCaster caster(grid);
  EXPECT_THROW(caster.update(COccupancyGridMap2D(0, 1, 0, 1, 0.1F), 0, 0, 1, 1), core::ContractError);
}

TEST(GridCaster, KeepsThePlacementOfTheGrid) {
  const auto grid = someGrid(true);
  const world::Plan plan = toPlan(grid);
  EXPECT_EQ(plan.columns, 100);
  EXPECT_EQ(plan.rows, 80);
  EXPECT_NEAR(plan.T_frame_raster.x, -3, 1e-6);
  EXPECT_EQ(plan.at(61, 25), world::Cell::kUnknown);
  EXPECT_EQ(plan.at(0, 5), world::Cell::kOccupied);
  EXPECT_EQ(plan.at(50, 79), world::Cell::kOccupied);
}

}  // namespace
}  // namespace slam::mrptworld
