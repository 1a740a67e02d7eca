#include "libslam/scanmatch/swept_match.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libslam/core/elementary.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::scanmatch {
namespace {

using core::Pose2;
using scanmatch_test::Lidar;
using scanmatch_test::rectangle;
using scanmatch_test::Wall;

std::vector<Wall> room() {
  auto walls = rectangle(-4, -3, 5, 3);
  for (const auto& wall : rectangle(2, 1, 2.5, 1.4)) walls.push_back(wall);
  return walls;
}

SurfelMap mapOfRoom() {
  core::RandomStream chance(3, "map");
  SurfelMap map(0.1, 0.005, true);
  map.clear({}, 30);
  for (int i = 0; i < 12; ++i) {
    const Pose2 T{0.05 * i, 0, i * core::kPi / 6};
    map.add(patchPoints(scanmatch_test::look(room(), T, Lidar(), chance), {}), T);
  }
  return map;
}

/// A scan of a robot that was T_end at its end and drove T_step meanwhile, beam by beam, deskewed as if that
/// had been T_told: its points, and how long ago each was measured.
struct Swept {
  std::vector<PatchPoint> points;
  std::vector<float> ago;
};
Swept sweep(const Pose2& T_end, const Pose2& T_step, const Pose2& T_told) {
  core::RandomStream chance(5, "swept");
  Swept swept;
  constexpr int kBeams = 240;
  for (int i = 0; i < kBeams; ++i) {
    const double ago = 1 - i / (kBeams - 1.0), angle = -core::kPi + 2 * core::kPi * i / kBeams;
    const Pose2 T_end_then = core::interpolate({}, core::inverse(T_step), ago),
                T_end_told = core::interpolate({}, core::inverse(T_told), ago);
    const Pose2 T_then = T_end * T_end_then;
    const double range_m = scanmatch_test::rayToWalls(room(), core::position(T_then), T_then.phi + angle) +
                           0.005 * chance.normal();
    const core::Point2 p = T_end_told * core::polar(range_m, angle);
    PatchPoint point;
    point.x = static_cast<float>(p.x), point.y = static_cast<float>(p.y);
    const double side = T_end_told.phi + angle + core::kPi / 2;  // the lidar is on the left of it
    point.along_x = static_cast<float>(0.01 * std::cos(side)),
    point.along_y = static_cast<float>(0.01 * std::sin(side));
    swept.points.push_back(point);
    swept.ago.push_back(static_cast<float>(ago));
  }
  return swept;
}

SweptPrior around(const Pose2& T_predicted) {
  SweptPrior prior;
  prior.before.mean = T_predicted;
  prior.before.information = Eigen::Vector3d(1e6, 1e6, 1e6).asDiagonal();  // the pose before: to a millimetre
  prior.step_information = Eigen::Vector3d(2500, 2500, 400).asDiagonal();  // 0.02 m, 0.05 rad
  return prior;
}

MatchOptions options() {
  MatchOptions result;
  result.information_scale = 10;  // the surfels are wide, and the points lie well within
  return result;
}

SweptMatch startAt(const Pose2& T_map_robot) {
  SweptMatch start;
  start.T_map_robot = T_map_robot;
  return start;
}

TEST(SweptMatch, FindsThePoseAndWhatOdometryMissedOfTheStep) {
  const SurfelMap map = mapOfRoom();
  const Pose2 T_before{0.2, 0.1, 0.3}, T_step{0.15, 0, 0.2}, T_told{0.12, 0, 0.14};
  const Pose2 T_end = T_before * T_step, T_predicted = T_before * T_told;
  const Swept swept = sweep(T_end, T_step, T_told);
  PosePrior loose;
  loose.mean = T_predicted;
  loose.information.setIdentity();
  const auto rigid = alignToSurfels(swept.points, map, T_predicted, loose, options());
  const auto match = alignSweptToSurfels(swept.points, swept.ago, map, startAt(rigid.T_map_robot),
                                         around(T_predicted), options());
  // As it is the scan lies where the robot was half of the error ago.
  EXPECT_GT(std::abs(core::angleDifference(rigid.T_map_robot.phi, T_end.phi)), 0.02);
  EXPECT_LT(std::abs(core::angleDifference(match.T_map_robot.phi, T_end.phi)), 0.005);
  EXPECT_LT(core::distance(match.T_map_robot, T_end), 0.4 * core::distance(rigid.T_map_robot, T_end));
  EXPECT_NEAR(match.more.z(), T_step.phi - T_told.phi, 0.006);
  EXPECT_NEAR(std::hypot(match.more.x(), match.more.y()), 0.03, 0.01);
  EXPECT_GT(match.score, rigid.score);
  // The points lie straight then: on the walls, as if all had been measured at the end.
  const auto straight = sweptBy(swept.points, swept.ago, match.more, match.T_map_robot.phi);
  EXPECT_GT(surfelScore(straight, map, T_end, 3, 1), 0.95);
  EXPECT_LT(surfelScore(swept.points, map, T_end, 3, 1), 0.9);
}

TEST(SweptMatch, WhereOdometryIsRightAStraightScanStaysWhereItIs) {
  const SurfelMap map = mapOfRoom();
  const Pose2 T_before{0.2, 0.1, 0.3}, T_step{0.15, 0, 0.2}, T_end = T_before * T_step;
  const Swept swept = sweep(T_end, T_step, T_step);
  const auto match =
      alignSweptToSurfels(swept.points, swept.ago, map, startAt(T_end), around(T_end), options());
  EXPECT_LT(core::distance(match.T_map_robot, T_end), 0.006);
  EXPECT_LT(std::abs(match.more.z()), 0.003);
}

TEST(SweptMatch, ErrsByThePriorWhereTheScanTellsNothing) {
  // Along a bare wall neither the pose nor the step is seen.
  core::RandomStream chance(3, "wall");
  SurfelMap map(0.1, 0.02, true);
  map.clear({}, 30);
  const std::vector<Wall> wall = {{{-50, 2}, {50, 2}}};
  const Pose2 side{0, 0, core::kPi / 2};
  map.add(patchPoints(scanmatch_test::look(wall, side, Lidar(), chance), {}), side);
  const auto points = patchPoints(scanmatch_test::look(wall, side, Lidar(), chance), {});
  std::vector<float> ago;
  for (size_t i = 0; i < points.size(); ++i)
    ago.push_back(static_cast<float>(i) / static_cast<float>(points.size()));
  const auto match = alignSweptToSurfels(points, ago, map, startAt(side), around(side), options());
  const Eigen::Matrix3d by_prior = match.by_before + match.by_step;
  const double along_m = std::sqrt(by_prior(0, 0)), across_m = std::sqrt(by_prior(1, 1));
  EXPECT_GT(along_m, 0.01);  // the step's 0.02
  EXPECT_LT(across_m, 0.5 * along_m);
}

// Ahead a scan has more points than those from farther back that made the map.
TEST(SweptMatch, ABareCorridorDoesNotHoldTheRobotBack) {
  const auto walls = rectangle(-200, -1, 200, 1);
  Lidar near_sighted;
  near_sighted.beams = 360, near_sighted.fov_rad = 2 * core::kPi;
  near_sighted.max_range_m = 3.5, near_sighted.noise_m = 0.03;
  SweptPrior prior;
  prior.before.mean = {0.1, 0, 0};
  prior.before.information = Eigen::Vector3d(1700, 1700, 1e4).asDiagonal();
  prior.step_information = prior.before.information;
  double found_m = 0;
  constexpr int kDrawn = 20;
  for (std::uint64_t seed = 1; seed <= kDrawn; ++seed) {
    core::RandomStream chance(seed, "scans");
    SurfelMap map(0.1, 0.005, true);
    map.clear({}, 10);
    for (int i = 0; i <= 7; ++i) {
      const Pose2 T{-0.3 * i, 0, 0};
      map.add(patchPoints(scanmatch_test::look(walls, T, near_sighted, chance), {}), T);
    }
    const auto points = patchPoints(scanmatch_test::look(walls, prior.before.mean, near_sighted, chance), {});
    std::vector<float> ago;
    for (size_t i = 0; i < points.size(); ++i)
      ago.push_back(1 - static_cast<float>(i) / static_cast<float>(points.size()));
    found_m +=
        alignSweptToSurfels(points, ago, map, startAt(prior.before.mean), prior, options()).T_map_robot.x /
        kDrawn;
  }
  EXPECT_NEAR(found_m, prior.before.mean.x, 0.003);
}

TEST(SweptMatch, WithoutPointsNothingMoves) {
  const auto match = alignSweptToSurfels({}, {}, mapOfRoom(), startAt({1, 2, 3}), around({}), options());
  EXPECT_EQ(match.T_map_robot.x, 1);
  EXPECT_EQ(match.score, 0);
  EXPECT_TRUE(match.more.isZero());
}

}  // namespace
}  // namespace slam::scanmatch
