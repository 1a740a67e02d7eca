#include "libslam/scanmatch/field_matcher.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>

#include "libslam/core/random.h"

namespace slam::scanmatch {
namespace {

struct Wall {
  core::Point2 a, b;
};

/// A room of 7 x 5 m with a niche and a pillar, turned against the grid.
std::vector<Wall> room() {
  std::vector<Wall> walls;
  for (const auto& loop :
       std::vector<std::vector<core::Point2>>{{{-3, -2}, {4, -2}, {4, 2}, {3, 2}, {3, 3}, {-3, 3}},
                                              {{1.5, 0.5}, {1.9, 0.5}, {1.9, 0.9}, {1.5, 0.9}}})
    for (size_t i = 0; i < loop.size(); ++i)
      walls.push_back(
          {core::Pose2{0, 0, 0.3} * loop[i], core::Pose2{0, 0, 0.3} * loop[(i + 1) % loop.size()]});
  return walls;
}

std::vector<Wall> corridor(double heading_rad) {
  const core::Pose2 T{0, 0, heading_rad};
  return {{T * core::Point2{-60, -1}, T * core::Point2{60, -1}},
          {T * core::Point2{-60, 1}, T * core::Point2{60, 1}}};
}

lidar::Scan scanOf(const std::vector<Wall>& walls, const core::Pose2& T_map_robot,
                   core::RandomStream* noise = nullptr) {
  lidar::Scan scan;
  const int beams = 271;
  scan.first_angle_rad = core::degToRad(-135), scan.step_rad = core::degToRad(1), scan.max_range_m = 12;
  for (int i = 0; i < beams; ++i) {
    const double angle = T_map_robot.phi + scan.angle(static_cast<size_t>(i));
    const double dx = std::cos(angle), dy = std::sin(angle);
    double nearest = std::numeric_limits<double>::infinity();
    for (const Wall& wall : walls) {
      const double ex = wall.b.x - wall.a.x, ey = wall.b.y - wall.a.y, det = ex * dy - ey * dx;
      if (det == 0) continue;
      const double ax = wall.a.x - T_map_robot.x, ay = wall.a.y - T_map_robot.y;
      const double range = (ex * ay - ey * ax) / det, along = (dx * ay - dy * ax) / det;
      if (range > 0 && along >= 0 && along <= 1) nearest = std::min(nearest, range);
    }
    if (noise) nearest += noise->normal(0.01);
    scan.ranges_m.push_back(nearest < scan.max_range_m ? static_cast<float>(nearest) : lidar::kNoReturn);
  }
  return scan;
}

gridmap::Grid gridOf(const std::vector<Wall>& walls, const std::vector<core::Pose2>& poses) {
  gridmap::GridOptions options;
  options.cell_m = 0.1, options.reach_cells = 4;
  gridmap::Grid grid(options);
  for (const auto& pose : poses) grid.insert(gridmap::scanRays(scanOf(walls, pose), {}), pose);
  return grid;
}

const ScanPointOptions kPoints;

// Exact ranges in a map of exact ranges: what is left is the map's, cells of 10 cm whose corners are rounded.
TEST(FieldMatcher, FindsThePoseFinerThanTheCells) {
  const auto walls = room();
  const auto grid = gridOf(walls, {{0, 0, 0}, {0.5, 0.3, 0.5}, {-0.6, -0.2, 2}});
  core::RandomStream random(1, "poses");
  for (int i = 0; i < 30; ++i) {
    const core::Pose2 truth{random.uniform(-0.5, 0.8), random.uniform(-0.5, 0.5), random.uniform(-3, 3)};
    const core::Pose2 start{truth.x + random.uniform(-0.1, 0.1), truth.y + random.uniform(-0.1, 0.1),
                            truth.phi + random.uniform(-0.08, 0.08)};
    const auto match = alignToField(surfacePoints(scanOf(walls, truth), kPoints), grid, start, {}, {});
    EXPECT_LT(core::distance(match.T_map_robot, truth), 0.012);
    EXPECT_LT(std::abs(core::angleDifference(match.T_map_robot.phi, truth.phi)), core::degToRad(0.2));
    EXPECT_GT(match.score, 0.9);
    EXPECT_FALSE(match.degenerate);
  }
}

TEST(FieldMatcher, ReportsACorridorAndLeavesItsDirectionToTheOdometry) {
  for (const double heading : {0.0, 0.4, 1.3, -2.2}) {
    const auto walls = corridor(heading);
    const core::Pose2 start{0, 0, heading};
    const auto grid = gridOf(walls, {start});
    const core::Pose2 truth = start * core::Pose2{0.05, 0.03, 0.02}, wheels = start * core::Pose2{0.09, 0, 0};
    PosePrior prior;
    prior.mean = wheels;
    prior.information.diagonal() << 1 / (0.03 * 0.03), 1 / (0.03 * 0.03), 1 / (0.05 * 0.05);
    const auto match = alignToField(surfacePoints(scanOf(walls, truth), kPoints), grid, wheels, prior, {});
    EXPECT_TRUE(match.degenerate) << heading;
    EXPECT_NEAR(
        std::abs(match.free_direction.x * std::cos(heading) + match.free_direction.y * std::sin(heading)), 1,
        0.01);
    EXPECT_GT(match.free_sigma_m, 20 * match.fixed_sigma_m);
    const auto off = core::between(start, match.T_map_robot);
    EXPECT_NEAR(off.x, 0.09, 0.01);
    EXPECT_NEAR(off.y, 0.03, 0.005);
    EXPECT_NEAR(off.phi, 0.02, 0.003);
  }
}

TEST(FieldMatcher, TheInformationIsThatOfTheErrorsWhereBeamsErrAlone) {
  const auto walls = room();
  const auto grid = gridOf(walls, {{0, 0, 0}, {0.4, 0.3, 1}, {-0.4, 0, 3}});
  core::RandomStream noise(3, "noise");
  const core::Pose2 truth{0.1, 0.05, 0.2};
  FieldMatchOptions options;
  options.sigma_m = 0.01, options.information_scale = 1;
  double nees = 0;
  const int runs = 200;
  const auto exact =
      alignToField(surfacePoints(scanOf(walls, truth), kPoints), grid, truth, {}, options).T_map_robot;
  for (int i = 0; i < runs; ++i) {
    const auto match =
        alignToField(surfacePoints(scanOf(walls, truth, &noise), kPoints), grid, truth, {}, options);
    const Eigen::Vector3d error(match.T_map_robot.x - exact.x, match.T_map_robot.y - exact.y,
                                core::angleDifference(match.T_map_robot.phi, exact.phi));
    nees += error.dot(match.information * error) / 3 / runs;
  }
  // Normals are of noisy points and the kernel takes weight off: good to a factor.
  EXPECT_GT(nees, 0.4);
  EXPECT_LT(nees, 2.0);
}

TEST(FieldMatcher, APersonInTheWayDoesNotPullTheMatch) {
  const auto walls = room();
  const auto grid = gridOf(walls, {{0, 0, 0}});
  auto scan = scanOf(walls, {});
  for (size_t i = 130; i < 160; ++i) scan.ranges_m[i] = 0.8F;
  const auto match = alignToField(surfacePoints(scan, kPoints), grid, {0.03, -0.03, 0.02}, {}, {});
  EXPECT_LT(core::distance(match.T_map_robot, {}), 0.01);
  EXPECT_LT(match.score, 0.95);
}

// Points whose direction the noise hides once held the scan where the map's returns were: the robot lagged by
// 2 % of its way along a corridor.
TEST(FieldMatcher, PointsWithoutANormalHardlyHoldAScanAlongACorridor) {
  const auto walls = corridor(0.4);
  const core::Pose2 start{0, 0, 0.4};
  const auto grid = gridOf(walls, {start});
  const core::Pose2 wheels = start * core::Pose2{0.09, 0, 0};
  auto points = surfacePoints(scanOf(walls, wheels), kPoints);
  for (size_t i = 0; i < points.size(); i += 12) points[i].n = {0, 0};
  PosePrior prior;
  prior.mean = wheels;
  prior.information.diagonal() << 1 / (0.03 * 0.03), 1 / (0.03 * 0.03), 1 / (0.05 * 0.05);
  const auto off = core::between(start, alignToField(points, grid, wheels, prior, {}).T_map_robot);
  EXPECT_NEAR(off.x, 0.09, 0.025);  // 0.079 off at full weight
  EXPECT_NEAR(off.y, 0, 0.005);
}

// To both sides of the robot, a metre off: a radian moves them by as much as a metre does.
TEST(FieldMatcher, PointsWithoutANormalHoldTheHeadingByTheirLever) {
  const auto grid = gridOf(corridor(0), {{0, 0, 0}});
  const std::vector<SurfacePoint> points = {{{0, 1}, {}}, {{0, -1}, {}}};
  const auto match = alignToField(points, grid, {}, {}, {});
  ASSERT_GT(match.information(0, 0), 0);
  EXPECT_NEAR(match.information(2, 2) / match.information(0, 0), 1, 0.05);
}

TEST(FieldMatcher, TheResidualIsTheNoiseOfTheRanges) {
  const auto walls = room();
  const auto grid = gridOf(walls, {{0, 0, 0}, {0.4, 0.3, 1}, {-0.4, 0, 3}});
  core::RandomStream noise(3, "noise");
  const core::Pose2 truth{0.1, 0.05, 0.2};
  const auto exact = alignToField(surfacePoints(scanOf(walls, truth), kPoints), grid, truth, {}, {});
  const auto noisy = alignToField(surfacePoints(scanOf(walls, truth, &noise), kPoints), grid, truth, {}, {});
  // The ranges' 1 cm across the walls, on top of what the map's cells are off by.
  EXPECT_LT(exact.residual_m, 0.012);
  EXPECT_GT(noisy.residual_m, 0.007);
  EXPECT_LT(noisy.residual_m, 0.016);
  EXPECT_GT(noisy.residual_m, 1.1 * exact.residual_m);
}

TEST(FieldMatcher, WithoutPointsOrMapThePriorStandsAndTheMatchIsDegenerate) {
  const gridmap::Grid empty({});
  PosePrior prior;
  prior.mean = {1, 2, 0.5};
  prior.information.setIdentity();
  const auto points = surfacePoints(scanOf(room(), {}), kPoints);
  for (const auto& some : {std::vector<SurfacePoint>{}, points}) {
    const auto match = alignToField(some, empty, {1.1, 2, 0.5}, prior, {});
    EXPECT_NEAR(core::distance(match.T_map_robot, prior.mean), 0, 1e-5);
    EXPECT_TRUE(match.degenerate);
    EXPECT_EQ(match.score, 0);
  }
  EXPECT_EQ(fieldScore({}, empty, {}, 0.1, 3), 0);
}

TEST(FieldMatcher, TheScoreIsBestAtTheTruth) {
  const auto walls = room();
  const auto grid = gridOf(walls, {{0, 0, 0}});
  const auto points = surfacePoints(scanOf(walls, {}), kPoints);
  const double best = fieldScore(points, grid, {}, 0.1, 1);
  EXPECT_GT(best, 0.9);
  for (const core::Pose2& off : {core::Pose2{0.1, 0, 0}, {0, -0.1, 0}, {0, 0, 0.05}, {1, 1, 0}})
    EXPECT_LT(fieldScore(points, grid, off, 0.1, 1), best - 0.05);
}

// The vectors to the two cancel half way between them.
TEST(FieldMatcher, BetweenTwoSurfacesIsOnNeither) {
  gridmap::GridOptions options;
  options.cell_m = 0.1;
  gridmap::Grid grid(options);
  gridmap::ScanRays seen;
  for (int i = -4; i <= 4; ++i)
    for (const double x : {1.05, 1.35}) seen.rays.push_back({{x, 0.1 * i + 0.05}, true, {}});
  grid.insert(seen, {});
  SurfacePoint point;
  point.p = {1.2, 0.05};
  EXPECT_LT(fieldScore({point}, grid, {}, 0.05, 1), 0.2);
  point.p.x = 1.35;
  EXPECT_GT(fieldScore({point}, grid, {}, 0.05, 1), 0.9);
}

/// Two rooms on either side of a wall of 10 cm, that on the right to its other wall 5.9 m behind.
std::vector<Wall> twoRooms() {
  std::vector<Wall> walls;
  for (const auto& [left, right] : {std::pair{-3.0, 3.0}, {3.1, 9.0}})
    for (const Wall& wall : {Wall{{left, -2}, {right, -2}},
                             {{right, -2}, {right, 2}},
                             {{right, 2}, {left, 2}},
                             {{left, 2}, {left, -2}}})
      walls.push_back(wall);
  return walls;
}

// Of the right room the map knows nothing but its wall to the left one, from there.
TEST(FieldMatcher, AThinWallSeenFromBehindDoesNotPullTheMatch) {
  const auto walls = twoRooms();
  const core::Pose2 T_left{0, 0.3, 0.2}, T_right{5, -0.2, core::kPi - 0.3};
  auto grid = gridOf(walls, {T_left});
  const auto points = surfacePoints(scanOf(walls, T_right), kPoints);
  PosePrior prior{T_right, Eigen::Vector3d(1e4, 1e4, 1e5).asDiagonal()};
  const auto alone = alignToField(points, grid, T_right, prior, {});
  EXPECT_NEAR(alone.T_map_robot.x, T_right.x, 0.01);
  EXPECT_LT(alone.score, 0.05);
  EXPECT_LT(fieldScore(points, grid, T_right, 0.1, 1), 0.05);

  grid.insert(gridmap::scanRays(scanOf(walls, T_right), {}), T_right);
  for (const core::Pose2& T : {T_left, T_right}) {
    const auto match = alignToField(surfacePoints(scanOf(walls, T), kPoints), grid,
                                    {T.x + 0.06, T.y - 0.05, T.phi + 0.03}, {}, {});
    EXPECT_LT(core::distance(match.T_map_robot, T), 0.012);
    EXPECT_GT(match.score, 0.9);
  }
}

TEST(FieldTold, NothingByTheOtherFaceOfAWall) {
  const gridmap::Grid grid = gridOf({{{3, -6}, {3, 6}}}, {{0, 0, 0}});
  SurfacePoint point{{-2.15, 0}, {1, 0}};
  const core::Pose2 T{5.35, 0.05, 0};
  EXPECT_EQ(fieldTold({point}, grid, T, 1), 0);
  point.n = {};
  EXPECT_EQ(fieldTold({point}, grid, T, 1), 1);
}

TEST(FieldTold, IsWhatLiesOnSurfacesInSightOrBehindThem) {
  // From the origin ahead to a wall 3 m away, which ends 1 m to the left.
  const std::vector<Wall> wall = {{{3, -6}, {3, 1}}};
  const gridmap::Grid grid = gridOf(wall, {{0, 0, 0}});
  const auto told = [&](const core::Point2& p, const core::Pose2& T = {}) {
    SurfacePoint point{};
    point.p = core::inverse(T) * p;
    return fieldTold({point}, grid, T, 1) == 1;
  };
  EXPECT_TRUE(told({3, 0}));                        // on the wall
  EXPECT_TRUE(told({1.5, 0.2}));                    // where beams went
  EXPECT_TRUE(told({14, 1}));                       // through the wall, farther than beams went
  EXPECT_FALSE(told({12, 9}));                      // past its end, as far
  EXPECT_FALSE(told({-4, 0}));                      // behind the robot
  EXPECT_FALSE(told({3.02, -13}, {3.02, 0.9, 1}));  // along the wall, and beyond
  EXPECT_TRUE(told({14, -4}, {0, -4, 1}));          // as seen from the pose
}

TEST(FieldTold, IsAShare) {
  const gridmap::Grid grid = gridOf({{{3, -6}, {3, 1}}}, {{0, 0, 0}});
  std::vector<SurfacePoint> points(4);
  points[0].p = {3, 0}, points[1].p = {-4, 0}, points[2].p = {-5, 0}, points[3].p = {-6, 0};
  EXPECT_EQ(fieldTold(points, grid, {}, 1), 0.25);
  EXPECT_EQ(fieldTold(points, grid, {}, 2), 0.5);
  EXPECT_EQ(fieldTold({}, grid, {}, 1), 0);
}

}  // namespace
}  // namespace slam::scanmatch
