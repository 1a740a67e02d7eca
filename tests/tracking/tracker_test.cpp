#include "libslam/tracking/tracker.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libslam/keyframes/matching.h"
#include "libslam/lidar/deskew.h"
#include "libslam/tracking/pose_uncertainty.h"
#include "tests/keyframes/drawn_map.h"
#include "tests/scanmatch/drawn_rooms.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using keyframes::test_maps::addKeyframe;
using keyframes::test_maps::addRow;
using scanmatch_test::rectangle;

const Pose2 kHere{3, 2, 0.4};

std::vector<scanmatch_test::Wall> oneWall() {
  return {{{-100, 0}, {100, 0}}};
}

/// A room, seen by a few keyframes from around kHere; the tracker's map is of them.
struct Room {
  std::vector<scanmatch_test::Wall> walls;
  scanmatch_test::Lidar lidar;
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  Tracker tracker{map};

  explicit Room(std::vector<scanmatch_test::Wall> seen = withPillars()) : walls(std::move(seen)) {
    for (int k = 0; k < 6; ++k)
      addKeyframe(map, {kHere.x + 0.1 * k - 0.3, kHere.y, kHere.phi},
                  look({kHere.x + 0.1 * k - 0.3, kHere.y, kHere.phi}, 0), 0.1 * k, k - 1);
    tracker.around().fillAround(map.lastKeyframe(), kHere);
  }
  static std::vector<scanmatch_test::Wall> withPillars() {
    auto walls = rectangle(0, 0, 8, 5);
    for (const core::Point2 p : {core::Point2{6, 1}, {5.5, 3.8}, {7, 2.6}, {4.2, 4.4}}) {
      const auto pillar = rectangle(p.x, p.y, p.x + 0.4, p.y + 0.3);
      walls.insert(walls.end(), pillar.begin(), pillar.end());
    }
    return walls;
  }
  lidar::Scan look(const Pose2& T_world_robot, double time_s) const {
    core::RandomStream chance(7, "tracker");
    auto scan = scanmatch_test::look(walls, T_world_robot, lidar, chance);
    scan.time_s = time_s;
    return scan;
  }
  /// One scan at kHere was taken in; now comes one after a step that odometry has as it is told.
  Tracker::Match after(const Pose2& T_step, const Pose2& T_odometry, bool has_odometry = true) {
    const auto first = look(kHere, 0), second = look(kHere * T_step, 0.2);
    tracker.motion().begin(first, {}, has_odometry);
    tracker.motion().end(first);
    has_odometry = tracker.motion().begin(second, T_odometry, has_odometry);
    points = keyframes::pointsOf(second, map.options());
    expected = tracker.expect(kHere, T_odometry, has_odometry);
    return tracker.match(second, points, expected);
  }
  Tracker::Points points;
  Expected expected{};
};

double metresOff(const Tracker::Match& match, const Pose2& T_step) {
  return core::distance(match.result.T_map_robot, kHere * T_step);
}
double turnOff(const Tracker::Match& match, const Pose2& T_step) {
  return std::abs(core::angleDifference(match.result.T_map_robot.phi, kHere.phi + T_step.phi));
}

TEST(Tracker, FindsWhereAScanLies) {
  Room room;
  const Pose2 T_step{0.15, 0, 0.1};
  const auto match = room.after(T_step, {0.14, 0, 0.11});
  EXPECT_LT(metresOff(match, T_step), 0.01);
  EXPECT_LT(turnOff(match, T_step), 0.005);
  EXPECT_GT(match.result.score, 0.9);
  EXPECT_FALSE(match.is_odometry_dropped);
}

TEST(Tracker, FollowsTheScanWhereOdometryMissesATurn) {
  Room room;
  const Pose2 T_step{0.1, 0, 0.2};
  const auto match = room.after(T_step, {0.1, 0, 0});
  EXPECT_LT(metresOff(match, T_step), 0.02);
  EXPECT_LT(turnOff(match, T_step), 0.01);
}

TEST(Tracker, TurnsAsFarAsWheelsHaveMissedTurnsBefore) {
  Room room;
  Motion& motion = room.tracker.motion();
  for (int i = 0; i < 200; ++i) {  // worse and worse: nothing is learnt of a single one that is far off
    const double off_rad = 0.02 + 0.002 * i;
    motion.learn({0.1, 0, 0.6}, {0.1, 0, 0.6 + (i % 2 == 0 ? off_rad : -off_rad)}, 1, 1, true);
  }
  ASSERT_GT(motion.sigmaOfWheels_rad({0.1, 0, 0.3}), 0.18);
  // The scan before is another lidar's: only the map tells.
  auto first = room.look(kHere, 0);
  first.T_robot_lidar = {0, 0, core::kPi};
  const Pose2 T_step{0.1, 0, 1.0}, T_odometry{0.1, 0, 0.3};
  const auto second = room.look(kHere * T_step, 0.2);
  motion.begin(first, {}, true);
  motion.end(first);
  motion.begin(second, T_odometry, true);
  const auto points = keyframes::pointsOf(second, room.map.options());
  const auto match = room.tracker.match(second, points, room.tracker.expect(kHere, T_odometry, true));
  EXPECT_LT(turnOff(match, T_step), 0.01);
  EXPECT_LT(metresOff(match, T_step), 0.02);
}

// Along a corridor with a post like the next two scans tell how the robot turned, but not how far it went.
TEST(Tracker, WhereWheelsMissATurnTheirMetresHoldAlongACorridor) {
  constexpr double kApart_m = 1.3;
  std::vector<scanmatch_test::Wall> walls = {{{-100, 1}, {100, 1}}, {{-100, 3}, {100, 3}}};
  for (int i = -20; i < 20; ++i) {
    const auto post = rectangle(kApart_m * i, 1, kApart_m * i + 0.2, 1.15);
    walls.insert(walls.end(), post.begin(), post.end());
  }
  const Pose2 T_step{1.1, 0, -0.3};
  for (const double missed_rad : {-0.5, -0.45, -0.4, -0.35, -0.3, 0.3, 0.35, 0.4, 0.45, 0.5}) {
    Room room(walls);
    Motion& motion = room.tracker.motion();
    for (int i = 0; i < 200; ++i) motion.learn({0.1, 0, 0.6}, {0.1, 0, i % 2 == 0 ? 0.8 : 0.4}, 1, 1, true);
    // Along an arc the chord turns by half.
    const Pose2 T_odometry{1.1 * std::cos(missed_rad / 2), 1.1 * std::sin(missed_rad / 2),
                           T_step.phi + missed_rad};
    // What was seen from a post farther on.
    const auto first = room.look({kHere.x + kApart_m, kHere.y, kHere.phi}, 0),
               second = room.look(kHere * T_step, 0.2);
    motion.begin(first, {}, true);
    motion.end(first);
    motion.begin(second, T_odometry, true);
    const auto points = keyframes::pointsOf(second, room.map.options());
    const auto match = room.tracker.match(second, points, room.tracker.expect(kHere, T_odometry, true));
    EXPECT_LT(turnOff(match, T_step), 0.02) << missed_rad;
    EXPECT_LT(metresOff(match, T_step), 0.3) << missed_rad;
  }
}

TEST(Tracker, FindsMetresThatAreCountedTheOtherWay) {
  Room room;
  const Pose2 T_step{-0.5, 0, 0};
  const auto match = room.after(T_step, {0.5, 0, 0});
  EXPECT_LT(metresOff(match, T_step), 0.02);
}

TEST(Tracker, WithoutOdometryEveryPlaceWithinReachIsAStart) {
  Room room;
  const Pose2 T_step{0.45, 0.1, 0.7};
  const auto match = room.after(T_step, {}, false);
  EXPECT_LT(metresOff(match, T_step), 0.02);
  EXPECT_LT(turnOff(match, T_step), 0.01);
}

TEST(Tracker, AlongABareWallOdometryHoldsTheScan) {
  Room room(oneWall());
  const Pose2 T_step{0.2, 0, -0.02};
  const auto match = room.after(T_step, T_step);
  // A robot that looks along it at an angle: what it went along the wall nothing but odometry tells.
  EXPECT_LT(metresOff(match, T_step), 0.01);
  EXPECT_FALSE(match.is_odometry_dropped);
}

TEST(Tracker, WhereOdometryWasLetGoKeyframesDoNotVouchForThemselvesUntilScansAreExplained) {
  Room room;
  const Pose2 T_step{0.1, 0, 0.2};
  const auto match = room.after(T_step, {0.1, 0, 0});
  room.tracker.noteMatch(match.result.T_map_robot, room.points, room.expected, true);
  ASSERT_TRUE(room.tracker.isFollowingWheels());
  const int k = addKeyframe(room.map, match.result.T_map_robot, room.look(kHere * T_step, 0.2), 0.7,
                            room.map.lastKeyframe());
  room.map.keyframes().back().unsure = true;
  // Odometry goes on where it believes to be; the scans are explained where the robot is.
  for (int i = 1; i < room.map.options().loop_confirmations; ++i) {
    ASSERT_TRUE(room.tracker.isFollowingWheels());
    EXPECT_TRUE(room.map.keyframe(k).unsure);
    const auto scan = room.look(kHere * T_step, 0.2 + 0.2 * i);
    room.tracker.motion().begin(scan, {}, true);
    const Expected expected = room.tracker.expect(match.result.T_map_robot, {}, true);
    EXPECT_EQ(expected.by_wheels.phi, kHere.phi);
    room.tracker.noteMatch(match.result.T_map_robot, room.points, expected, true);
    room.tracker.motion().end(scan);
  }
  EXPECT_FALSE(room.tracker.isFollowingWheels());
  EXPECT_FALSE(room.map.keyframe(k).unsure);
}

/// What a lidar that takes the whole period sees while the robot drives T_step to kHere * T_step, deskewed as
/// odometry has the step.
lidar::Scan sweptScan(const Room& room, const Pose2& T_step, const Pose2& T_odometry) {
  const lidar::Sweep sweep{0.2};
  auto scan = room.look(kHere * T_step, 0.2);
  const auto last = static_cast<double>(scan.ranges_m.size() - 1);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const Pose2 T_then =
        kHere * T_step * core::interpolate({}, core::inverse(T_step), 1 - static_cast<double>(i) / last);
    scan.ranges_m[i] = static_cast<float>(
        scanmatch_test::rayToWalls(room.walls, core::position(T_then), T_then.phi + scan.angle(i)));
  }
  return lidar::deskewed(scan, T_odometry, 0.2, sweep);
}

// Nothing holds the robot along a bare wall, and the map around moves along with it: against that map it errs
// by some of the last steps, not by all of the drive.
TEST(Tracker, AlongABareWallASpinningLidarErrsAgainstTheMapAroundByTheLastStepsAlone) {
  Room room(oneWall());
  const auto scan = sweptScan(room, {}, {});
  const auto points = keyframes::pointsOf(scan, room.map.options());
  const Expected expected = room.tracker.expect(kHere, {}, true);
  const auto match = room.tracker.match(scan, points, expected);
  std::vector<double> along_m2;
  for (int i = 0; i < 40; ++i) {
    const auto unskewed = room.tracker.unskew(scan, points, expected, match.result);
    ASSERT_TRUE(unskewed.has_value()) << i;
    along_m2.push_back(unskewed->noise(0, 0));
  }
  EXPECT_GT(along_m2[3], 1.5 * along_m2[0]);
  EXPECT_LT(along_m2[39], 8 * along_m2[0]);
}

TEST(Tracker, SetsRightWhatOdometryErrsByInASweep) {
  Room room;
  const Pose2 T_step{0.15, 0, 0.15}, T_odometry{0.15, 0, 0.1};
  const auto first = room.look(kHere, 0);
  room.tracker.motion().begin(first, {}, true);
  room.tracker.motion().end(first);
  const auto scan = sweptScan(room, T_step, T_odometry);
  room.tracker.motion().begin(scan, T_odometry, true);
  const auto points = keyframes::pointsOf(scan, room.map.options());
  const Expected expected = room.tracker.expect(kHere, T_odometry, true);
  const auto match = room.tracker.match(scan, points, expected);
  const auto unskewed = room.tracker.unskew(scan, points, expected, match.result);
  ASSERT_TRUE(unskewed.has_value());
  const double before = turnOff(match, T_step),
               after =
                   std::abs(core::angleDifference(unskewed->match.T_map_robot.phi, kHere.phi + T_step.phi));
  EXPECT_GT(before, 0.015);
  EXPECT_LT(after, 0.3 * before);
  EXPECT_NEAR(unskewed->match.more.z(), 0.05, 0.015);
  EXPECT_GT(std::sqrt(unskewed->noise(2, 2)), 0.3 * after);
  const LocalMap& around = room.tracker.around();
  EXPECT_GT(around.toldScore(unskewed->points, kHere * T_step),
            around.toldScore(points, kHere * T_step) + 0.1);
  // The scan that is kept looks as if it had been taken at once.
  const auto straight = room.look(kHere * T_step, 0.2);
  const auto meanOff = [&](const lidar::Scan& one) {
    double sum_m = 0;
    int count = 0;
    for (size_t i = 0; i < one.ranges_m.size(); ++i)
      if (lidar::isReturn(one.ranges_m[i]) && std::abs(one.ranges_m[i] - straight.ranges_m[i]) < 0.3)
        sum_m += std::abs(one.ranges_m[i] - straight.ranges_m[i]), ++count;
    return sum_m / count;
  };
  EXPECT_LT(meanOff(unskewed->scan), 0.7 * meanOff(scan));
  auto endless = scan;  // nobody knows how it was swept
  endless.deskewing.sweep.duration_s = 1000;
  EXPECT_FALSE(room.tracker.unskew(endless, points, expected, match.result).has_value());
  auto at_once = scan;
  at_once.deskewing = {};
  EXPECT_FALSE(room.tracker.unskew(at_once, points, expected, match.result).has_value());
}

TEST(LocalMap, SaysWhatItKnowsOfAScan) {
  Room room;
  const LocalMap& around = room.tracker.around();
  const auto points = keyframes::pointsOf(room.look(kHere, 0), room.map.options());
  const Pose2 T_wrong{kHere.x, kHere.y, kHere.phi + 0.4};
  EXPECT_GT(around.toldScore(points, kHere), 0.9);
  EXPECT_LT(around.toldScore(points, T_wrong), 0.5);
  EXPECT_GT(around.gain(points, kHere, T_wrong), 0.4);
  EXPECT_NEAR(around.gain(points, kHere, T_wrong), -around.gain(points, T_wrong, kHere), 1e-12);
  EXPECT_GT(around.knownShare(points, kHere), 0.95);
  EXPECT_LT(around.knownShare(points, {kHere.x + 20, kHere.y, kHere.phi}), 0.05);
}

TEST(LocalMap, PointsBeyondWhatWasSeenAreNotHeldAgainstAPose) {
  // The keyframes have seen the room through a lidar of 90 degrees; the scan looks all round.
  Room room;
  room.lidar.fov_rad = 1.5;
  keyframes::KeyframeMap map{keyframes::GraphOptions()};
  for (int k = 0; k < 3; ++k) addKeyframe(map, kHere, room.look(kHere, 0), 0.1 * k, k - 1);
  LocalMap around(map);
  around.fillAround(0, kHere);
  room.lidar.fov_rad = 6;
  const auto points = keyframes::pointsOf(room.look(kHere, 0), map.options());
  EXPECT_LT(around.knownShare(points, kHere), 0.5);
  EXPECT_GT(around.toldScore(points, kHere), 0.9);
}

TEST(PoseUncertainty, GrowsAlongAWallByOdometryAndStaysSmallAcrossIt) {
  Room room(oneWall());
  PoseUncertainty uncertainty(room.map);
  const Pose2 T_step{0.2, 0, 0};
  const auto match = room.after(T_step, T_step);
  Pose2 T_before = kHere;
  double before = 0;
  for (int i = 0; i < 5; ++i) {
    uncertainty.noteEvidence(room.points, match.result.T_map_robot, room.tracker.around().maps().fine);
    Expected expected = room.expected;
    expected.T_before = T_before;
    uncertainty.carryOn(expected, match.result);
    EXPECT_GT(uncertainty.covariance()(0, 0), before);  // the wall runs along x
    before = uncertainty.covariance()(0, 0);
  }
  EXPECT_GT(before, 20 * uncertainty.covariance()(1, 1));
  EXPECT_GT(uncertainty.sinceKeyframe(1)(0, 0), 0);
  const Eigen::Matrix3d since = uncertainty.sinceKeyframe(1);
  uncertainty.hangOnKeyframe();
  EXPECT_GE(uncertainty.sinceKeyframe(1)(0, 0), since(0, 0));  // the keyframe does not tell it either
  EXPECT_GT(uncertainty.sinceKeyframe(1)(1, 1), since(1, 1));
  uncertainty.beginKeyframe(1);
  EXPECT_EQ(uncertainty.sinceKeyframe(1)(0, 0), 0);
  EXPECT_GT(uncertainty.sinceKeyframe(0)(1, 1), 0);  // the first keyframe's pose is given: both views err
}

// Half a metre and 10 mrad, seen from a keyframe that has turned; its own error comes along.
TEST(PoseUncertainty, OfAKeyframeThatOdometryAloneTellsOfIsThatOfItsEdge) {
  keyframes::KeyframeMap map{keyframes::GraphOptions{}};
  addRow(map, 2);
  map.graph().setPose(1, {1, 0, core::kPi / 2});
  posegraph::Edge edge;
  edge.from = 0, edge.to = 1, edge.information = Eigen::Vector3d(4, 1e6, 1e4).asDiagonal();
  map.keyframes()[1].odometry_edge = map.graph().addEdge(edge);
  PoseUncertainty uncertainty(map);
  uncertainty.inherit(1);
  EXPECT_NEAR(uncertainty.covariance()(1, 1), 0.25, 0.1) << "along the robot's x, the map's y";
  EXPECT_LT(uncertainty.covariance()(0, 0), 1e-4);
  EXPECT_NEAR(uncertainty.covariance()(2, 2), 1e-4, 0.4e-4);
  keyframes::ErrorSamples turned;
  turned.addNew(Eigen::Vector3d(0, 0, 1).asDiagonal(), 7);
  map.setErrors(0, turned);
  uncertainty.inherit(1);
  EXPECT_GT(uncertainty.covariance()(1, 1), 0.75) << "a metre on its heading's error shows";
}

TEST(PoseUncertainty, AfterALoopIsThatOfTheKeyframeAndOfTheWaySince) {
  Room room(oneWall());
  PoseUncertainty uncertainty(room.map);
  const auto match = room.after({0.2, 0, 0}, {0.2, 0, 0});
  uncertainty.noteEvidence(room.points, match.result.T_map_robot, room.tracker.around().maps().fine);
  uncertainty.carryOn(room.expected, match.result);
  const double since = uncertainty.sinceKeyframe(1)(0, 0);
  ASSERT_GT(since, 0);
  uncertainty.setCovariance(Eigen::Vector3d(9, 9, 9).asDiagonal());
  room.map.setErrors(1, {});
  uncertainty.restartFrom(1, match.result.T_map_robot);
  EXPECT_NEAR(uncertainty.covariance()(0, 0), since, 0.4 * since);
  keyframes::ErrorSamples errors;
  errors.addNew(Eigen::Vector3d(4, 4, 0).asDiagonal(), 7);
  room.map.setErrors(1, errors);
  uncertainty.restartFrom(1, match.result.T_map_robot);
  EXPECT_NEAR(uncertainty.covariance()(0, 0), 4 + since, 1.6);
}

TEST(PoseUncertainty, WhatTheMatchDoesNotTellIsAdded) {
  Room room;
  const auto match = room.after({0.1, 0, 0}, {0.1, 0, 0});
  PoseUncertainty plain(room.map), swept(room.map);
  for (auto* one : {&plain, &swept})
    one->noteEvidence(room.points, match.result.T_map_robot, room.tracker.around().maps().fine);
  plain.carryOn(room.expected, match.result);
  const Eigen::Matrix3d told = swept.toldInformation();
  const Eigen::Matrix3d noise = Eigen::Vector3d(4e-4, 0, 1e-4).asDiagonal();
  swept.carryOn(room.expected, match.result, noise);
  EXPECT_NEAR(swept.noise()(0, 0), 4e-4, 4e-5);
  EXPECT_NEAR(swept.covariance()(0, 0) - plain.covariance()(0, 0), swept.noise()(0, 0) - plain.noise()(0, 0),
              0.4 * swept.noise()(0, 0));  // of 64 draws
  EXPECT_NEAR(swept.noise()(1, 1), plain.noise()(1, 1),
              0.1 * plain.noise()(1, 1));  // no less than the match's
  EXPECT_LT(swept.toldInformation()(2, 2), 0.5 * told(2, 2));
  // The next scan was taken at once.
  swept.carryOn(room.expected, match.result);
  EXPECT_NEAR(swept.noise()(0, 0), plain.noise()(0, 0), 1e-9);
}

}  // namespace
}  // namespace slam::tracking
