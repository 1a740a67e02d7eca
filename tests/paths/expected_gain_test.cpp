#include "libslam/paths/expected_gain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/paths/drawn_map.h"

namespace slam::paths {
namespace {

using core::kPi;

LookShape circle(double max_range_m) {
  LookShape view;
  view.full_circle = true;
  view.fov_rad = 2 * kPi;
  view.first_rad = -kPi;
  view.max_range_m = max_range_m;
  return view;
}

constexpr double kForEver_m = 1e9;  // rays pass the unknown as if it were free

/// A free hall with two walls and unknown parts, cells of 0.1 m.
FreeSpace hall() {
  return readFreeSpace(enlarged({"############",  //
                                 "#....#.????#",  //
                                 "#....#.????#",  //
                                 "#..........#",  //
                                 "#...######.#",  //
                                 "#??....????#",  //
                                 "#??....????#",  //
                                 "############"},
                                5, 0.1));
}

/// Area of the unknown cells that a straight line of sight reaches from p, sampled finely.
double visibleUnknown(const FreeSpace& space, const core::Point2& p, double max_range_m) {
  double area_m2 = 0;
  for (size_t cell = 0; cell < space.state.size(); ++cell) {
    const core::Point2 end = space.centreOf(cell);
    if (space.state[cell] != kUnknownCell || core::distance(p, end) > max_range_m) continue;
    bool seen = true;
    for (double s = 0; s < 1 && seen; s += 0.001)
      seen = space.at({p.x + s * (end.x - p.x), p.y + s * (end.y - p.y)}) != kOccupiedCell;
    if (seen) area_m2 += space.resolution_m * space.resolution_m;
  }
  return area_m2;
}

TEST(ExpectedGain, IsTheUnknownAreaInSightAsTheSearchOverAllCellsFindsIt) {
  const auto space = hall();
  for (const core::Point2 p : {core::Point2{1.1, 3.1}, {2.6, 0.9}, {5.2, 2.3}})
    for (const double range_m : {2.0, 5.0}) {
      const double expected = visibleUnknown(space, p, range_m);
      const auto profile = expectedGain(space, p, circle(range_m), kForEver_m, 720);
      // The search counts whole cells by their centres, along the edges of what is in sight too.
      EXPECT_NEAR(profile.total(), expected, 0.05 * expected + 0.05) << p.x << ", " << p.y << ", " << range_m;
    }
}

TEST(ExpectedGain, KnowsTheAreaOfADiscOfTheUnknown) {
  const auto space = readFreeSpace(enlarged({"?????", "?????", "?????"}, 20, 0.05));
  const auto profile = expectedGain(space, {2.5, 1.5}, circle(1.0), kForEver_m, 360);
  EXPECT_NEAR(profile.total(), kPi, 1e-8);  // wedges make the circle whatever the cells are
  // And with rays that end after 0.5 m of the unknown on average: 2 pi times the integral of r exp(-r / 0.5).
  const double damped = 2 * kPi * (0.25 - (0.5 + 0.25) * std::exp(-2.0));
  EXPECT_NEAR(expectedGain(space, {2.5, 1.5}, circle(1.0), 0.5, 360).total(), damped, 0.01 * damped);
}

TEST(ExpectedGain, OfAnExploredRoomIsNothing) {
  const auto space = readFreeSpace(enlarged({"####", "#..#", "#..#", "####", "????"}, 10, 0.05));
  EXPECT_EQ(expectedGain(space, {0.9, 1.4}, circle(10), kForEver_m, 90).total(), 0);
}

TEST(ExpectedGain, CountsWhatTheLidarCoversAndFindsTheHeadingForIt) {
  const auto space = hall();
  const core::Point2 p{1.1, 3.1};
  auto view = circle(10);
  view.full_circle = false;
  view.fov_rad = kPi / 2;
  view.first_rad = -kPi / 4;
  const auto profile = expectedGain(space, p, view, 3, 360);
  double sum = 0;
  for (const double heading : {0.0, kPi / 2, kPi, -kPi / 2}) sum += profile.within(view, heading);
  EXPECT_NEAR(sum, profile.total(), 1e-9);
  const double best = profile.bestHeading(view);
  for (double heading = -3; heading < 3; heading += 0.1)
    EXPECT_GE(profile.within(view, best) + 1e-12, profile.within(view, heading));
  double cells = 0;
  for (const auto& cell : expectedCells(space, p, view, best, 3, 360))
    cells += static_cast<double>(cell.second);
  EXPECT_NEAR(cells, profile.within(view, best), 1e-5);  // summed in single precision
}

TEST(LookShape, IsTakenFromTheScan) {
  lidar::Scan scan;
  scan.first_angle_rad = -kPi / 2;
  scan.step_rad = kPi / 180;
  scan.ranges_m.assign(181, 1.0F);
  scan.max_range_m = 8;
  scan.T_robot_lidar.phi = kPi / 2;
  const auto view = lookShape(scan);
  EXPECT_FALSE(view.full_circle);
  EXPECT_NEAR(view.first_rad, 0, 1e-12);
  EXPECT_NEAR(view.fov_rad, kPi, 1e-12);
  EXPECT_EQ(view.max_range_m, 8);
  scan.ranges_m.assign(360, 1.0F);
  EXPECT_TRUE(lookShape(scan).full_circle);
}

}  // namespace
}  // namespace slam::paths
