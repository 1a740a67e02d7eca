#include "libslam/obstacles/lidar_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libslam/core/random.h"
#include "libslam/obstacles/local_obstacle_map.h"

namespace slam::obstacles {
namespace {

using lidar::kLostReading;
using lidar::kNoReturn;

lidar::Scan scanOf(double first_deg, double step_deg, std::vector<float> ranges_m) {
  lidar::Scan scan;
  scan.first_angle_rad = core::degToRad(first_deg), scan.step_rad = core::degToRad(step_deg);
  scan.min_range_m = 0.1, scan.max_range_m = 8;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

SectorOptions sector(double width_deg, double reach_m = 0, double margin_m = 0) {
  SectorOptions options;
  options.width_rad = core::degToRad(width_deg), options.reach_m = reach_m, options.depth_margin_m = margin_m;
  return options;
}

core::Point2 at(double degrees, double range_m) {
  return {range_m * std::cos(core::degToRad(degrees)), range_m * std::sin(core::degToRad(degrees))};
}

TEST(LidarView, SeesAlongEachBeamUpToItsReturn) {
  const LidarView view(scanOf(-20, 10, {2, 3, kNoReturn, kLostReading, 1}), sector(60));
  EXPECT_TRUE(view.contains(at(-20, 1.99)));
  EXPECT_FALSE(view.contains(at(-20, 2.01)));
  EXPECT_TRUE(view.contains(at(-10, 2.99)));
  EXPECT_TRUE(view.contains(at(0, 7.99)));  // nothing up to the maximum range
  EXPECT_FALSE(view.contains(at(0, 8.01)));
  EXPECT_FALSE(view.contains(at(10, 0.5)));  // lost: nobody knows
  EXPECT_TRUE(view.contains(at(20, 0.99)));
  EXPECT_FALSE(view.contains(at(0, 0.09)));  // nearer than the lidar sees
  // A point belongs to the beam nearest in angle.
  EXPECT_TRUE(view.contains(at(-14.9, 2.5)));
  EXPECT_FALSE(view.contains(at(-15.1, 2.5)));
  EXPECT_TRUE(view.contains(at(24.9, 0.5)));
  EXPECT_FALSE(view.contains(at(25.1, 0.5)));  // beyond the last beam
  ASSERT_EQ(view.obstacles().size(), 3U);
  EXPECT_NEAR(core::distance(view.obstacles()[0], at(-20, 2)), 0, 1e-7);  // ranges are floats
  EXPECT_NEAR(core::distance(view.obstacles()[2], at(20, 1)), 0, 1e-7);
}

TEST(LidarView, IsCutToItsSectorAndReach) {
  const LidarView view(scanOf(-40, 20, {2, 2, 5, kNoReturn, 2}), sector(50, 3));
  EXPECT_EQ(view.obstacles().size(), 1U);  // at -20 degrees; 5 m are out of reach, +-40 out of the sector
  EXPECT_TRUE(view.contains(at(24, 2.9)));
  EXPECT_FALSE(view.contains(at(26, 1)));
  EXPECT_TRUE(view.contains(at(0, 2.9)));
  EXPECT_FALSE(view.contains(at(0, 3.1)));
}

TEST(LidarView, LooksAheadOfTheRobotHoweverTheLidarIsMounted) {
  auto scan = scanOf(-180, 10, std::vector<float>(36, 2.0F));
  scan.ranges_m[0] = 4;  // straight back of the lidar
  scan.T_robot_lidar = {0.3, -0.2, core::kPi};
  const LidarView view(scan, sector(61, 0, 0));
  EXPECT_TRUE(view.contains({0.3 + 3.9, -0.2}));  // ahead of the robot
  EXPECT_FALSE(view.contains({0.3 - 1, -0.2}));
  EXPECT_EQ(view.obstacles().size(), 7U);  // -30 .. 30 in steps of 10
  const auto border = view.outline(3);
  ASSERT_EQ(border.size(), 8U);
  EXPECT_NEAR(border[3].x, 0.3 + 3, 1e-9);  // cut at 3 m
  EXPECT_NEAR(border[7].x, 0.3, 1e-12);
}

TEST(LidarView, GoesRoundWithoutAGap) {
  const LidarView view(scanOf(-180, 10, std::vector<float>(36, 2.0F)), sector(360));
  core::RandomStream random(2, "round");
  for (int i = 0; i < 5000; ++i) {
    const core::Point2 p{random.uniform(-3, 3), random.uniform(-3, 3)};
    const double r = std::hypot(p.x, p.y);
    ASSERT_EQ(view.contains(p), r > 0.1 && r < 2) << p.x << ", " << p.y;
  }
}

TEST(LidarView, EqualsTheSearchForTheNearestBeam) {
  core::RandomStream random(6, "beams");
  for (int round = 0; round < 30; ++round) {
    const double first_deg = random.uniform(-180, 0), step_deg = random.uniform(1, 12);
    auto scan = scanOf(first_deg, step_deg, {});
    const auto beams =
        std::min<size_t>(3 + random.below(40), static_cast<size_t>(2 * core::kPi / scan.step_rad));
    for (size_t i = 0; i < beams; ++i)
      scan.ranges_m.push_back(random.chance(0.1)   ? kLostReading
                              : random.chance(0.1) ? kNoReturn
                                                   : static_cast<float>(random.uniform(0.2, 6)));
    scan.T_robot_lidar = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-3, 3)};
    const double width_deg = random.uniform(20, 360), margin_m = random.uniform(0, 0.3);
    const LidarView view(scan, sector(width_deg, 5, margin_m));
    for (int i = 0; i < 1000; ++i) {
      const core::Point2 p{random.uniform(-5, 5), random.uniform(-5, 5)};
      const core::Point2 p_lidar = core::inverse(scan.T_robot_lidar) * p;
      const double range_m = std::hypot(p_lidar.x, p_lidar.y);
      size_t nearest = 0;
      const auto gap = [&](size_t beam) {
        return std::abs(core::angleDifference(std::atan2(p_lidar.y, p_lidar.x), scan.angle(beam)));
      };
      for (size_t beam = 1; beam < beams; ++beam)
        if (gap(beam) < gap(nearest)) nearest = beam;
      const float reading_m = scan.ranges_m[nearest];
      const double depth_m = std::isnan(reading_m) ? 0
                             : std::isinf(reading_m)
                                 ? 5
                                 : std::min(5.0, static_cast<double>(reading_m) + margin_m);
      const double ahead_rad = std::atan2(p.y - scan.T_robot_lidar.y, p.x - scan.T_robot_lidar.x);
      // Where beams go all the way round, their ends may be up to one and a half steps apart.
      const bool covered = scan.isFullCircle() || gap(nearest) <= scan.step_rad / 2;
      const bool in_sector = std::abs(ahead_rad) <= core::degToRad(width_deg) / 2;
      ASSERT_EQ(view.contains(p), covered && in_sector && range_m > 0.1 && range_m < depth_m)
          << "round " << round << " at " << p.x << ", " << p.y;
    }
  }
}

TEST(LidarView, ClearsGhostsInFrontOfReturnsAndKeepsWhatIsHidden) {
  LocalObstacleMap map;
  const LidarView open(scanOf(-20, 10, std::vector<float>(5, kNoReturn)), sector(60));
  map.update(0, 0, open, {at(0, 1), at(0, 3), at(10, 2.05)});
  const LidarView wall(scanOf(-20, 10, std::vector<float>(5, 2.0F)), sector(60, 0, 0.1));
  map.update(0, 0, wall, wall.obstacles());
  // The ghost at 1 m is gone, the point behind the wall stays, the one just behind is the wall itself.
  ASSERT_EQ(map.rememberedCount(), 1U);
  EXPECT_NEAR(map.points()[0].x, 3, 1e-12);
  EXPECT_EQ(map.points().size(), 1U + 5U);
}

TEST(LidarView, OfAnEmptyScanSeesNothing) {
  const LidarView view(scanOf(0, 1, {}), sector(60));
  EXPECT_FALSE(view.contains({1, 0}));
  EXPECT_TRUE(view.outline(3).empty());
  EXPECT_TRUE(view.obstacles().empty());
}

}  // namespace
}  // namespace slam::obstacles
