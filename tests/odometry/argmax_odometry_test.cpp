#include <gtest/gtest.h>

#include <cmath>

#include "tests/odometry/scene.h"

namespace slam::odometry {
namespace {

using core::degToRad;
using core::kPi;
using core::Pose2;
using scenes::between;
using scenes::Lidar;
using scenes::look;
using scenes::make;
using scenes::oddRoom;
using scenes::Scene;

constexpr float kLost = lidar::kLostReading;

/// Eight beams, 45 degrees apart, given in the original document's order: straight ahead first, then
/// counter-clockwise.
lidar::Scan drawn(const std::vector<float>& original) {
  lidar::Scan scan;
  const size_t n = original.size();
  scan.step_rad = 2 * kPi / static_cast<double>(n);
  scan.first_angle_rad = -kPi;
  scan.max_range_m = 20;
  scan.range_sigma_m = 0.01;
  for (size_t i = 0; i < n; ++i) scan.ranges_m.push_back(original[(i + n / 2) % n]);
  return scan;
}

double turnSteps(const std::vector<float>& before, const std::vector<float>& after) {
  return between("argmax", drawn(before), drawn(after), MotionKind::kTurn).turn_reading_rad / (kPi / 4);
}

TEST(ArgmaxOdometry, ReadsATurnAsTheShiftOfTheLongestRange) {
  // The longest ray goes from index 3 to index 1: what was far to the left came nearer to the front, so the
  // robot turned left by two steps.
  EXPECT_DOUBLE_EQ(turnSteps({1, 1, 1, 9, 1, 1, 1, 1}, {1, 9, 1, 1, 1, 1, 1, 1}), 2);
  EXPECT_DOUBLE_EQ(turnSteps({1, 9, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 9, 1, 1, 1, 1}), -2);
}

TEST(ArgmaxOdometry, WrapsTheShiftIntoHalfACircleEitherWay) {
  EXPECT_DOUBLE_EQ(turnSteps({1, 9, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1, 1, 9}), 2);   // 1 - 7 = -6
  EXPECT_DOUBLE_EQ(turnSteps({1, 1, 1, 1, 1, 1, 1, 9}, {1, 9, 1, 1, 1, 1, 1, 1}), -2);  // 7 - 1 = 6
  EXPECT_DOUBLE_EQ(turnSteps({1, 1, 1, 1, 1, 9, 1, 1}, {1, 1, 9, 1, 1, 1, 1, 1}), 3);   // just below half
}

TEST(ArgmaxOdometry, ChangesTheSignOfExactlyHalfATurnAsTheOriginalDoes) {
  EXPECT_DOUBLE_EQ(turnSteps({9, 1, 1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 9, 1, 1, 1}), 4);   // 0 - 4 <= -N/2
  EXPECT_DOUBLE_EQ(turnSteps({1, 1, 1, 1, 9, 1, 1, 1}, {9, 1, 1, 1, 1, 1, 1, 1}), -4);  // 4 - 0 >= N/2
  // Of an odd number no shift is half of it: 4 of 9 stay as they are, 5 come the other way round.
  const auto steps = [](size_t before, size_t after) {
    std::vector<float> first(9, 1), second(9, 1);
    first[before] = second[after] = 9;
    return between("argmax", drawn(first), drawn(second), MotionKind::kTurn).turn_reading_rad / (2 * kPi / 9);
  };
  EXPECT_NEAR(steps(4, 0), 4, 1e-12);
  EXPECT_NEAR(steps(0, 4), -4, 1e-12);
  EXPECT_NEAR(steps(5, 0), -4, 1e-12);
}

TEST(ArgmaxOdometry, ReadsWholeDegreesOfAOneDegreeLidar) {
  const auto before = look(oddRoom(), {0, 0, 0}, {});
  for (const double degrees : {10.3, 10.7, -44.6, 120.4}) {
    const auto motion =
        between("argmax", before, look(oddRoom(), {0, 0, degToRad(degrees)}, {}), MotionKind::kTurn);
    const double read_deg = core::radToDeg(motion.turn_reading_rad);
    EXPECT_NEAR(read_deg, std::round(read_deg), 1e-9);
    EXPECT_NEAR(read_deg, degrees, 1.0) << "to a beam";
  }
}

TEST(ArgmaxOdometry, MeasuresAWholeCommandFromTheScanBeforeItHoweverManyWereTakenDuringIt) {
  const auto odometry = make("argmax");
  odometry->update(look(oddRoom(), {0, 0, 0}, {}));
  // Five parts of 0.6 degrees: each alone is less than what a beam can tell.
  double sum_rad = 0;
  ScanMotion motion;
  for (int part = 1; part <= 5; ++part) {
    motion = odometry->update(look(oddRoom(), {0, 0, degToRad(0.6 * part)}, {}),
                              Commanded(MotionKind::kTurn, part > 1));
    sum_rad += motion.T_previous_current.phi;
  }
  EXPECT_NEAR(core::radToDeg(sum_rad), 3, 1e-9) << "the increments make up the whole";
  EXPECT_NEAR(core::radToDeg(motion.turn_reading_rad), 3, 1e-9) << "the reading is that of the whole";
}

TEST(ArgmaxOdometry, MakesUpForAScanWithoutAReadingAtTheNextOneOfTheCommand) {
  const auto odometry = make("argmax");
  const float inf = lidar::kNoReturn;
  odometry->update(drawn({5, 1, 1, 1, 2, 1, 1, 1}));
  const auto begun = odometry->update(drawn({4, 1, 1, 1, 3, 1, 1, 1}), MotionKind::kMove);
  EXPECT_DOUBLE_EQ(begun.T_previous_current.x, 1);
  const auto blind = odometry->update(drawn({inf, 1, 1, 1, inf, 1, 1, 1}), {MotionKind::kMove, true});
  EXPECT_EQ(blind.T_previous_current.x, 0) << "stays where it was, not where the command began";
  EXPECT_EQ(blind.front_reading_m, 1) << "of the command so far: what was read last";
  EXPECT_FALSE(blind.reliable);
  const auto ended = odometry->update(drawn({2, 1, 1, 1, 5, 1, 1, 1}), {MotionKind::kMove, true});
  EXPECT_DOUBLE_EQ(ended.T_previous_current.x, 2);
  // The next command begins at the scan before it.
  const auto next = odometry->update(drawn({1.5, 1, 1, 1, 5.5, 1, 1, 1}), MotionKind::kMove);
  EXPECT_DOUBLE_EQ(next.front_reading_m, 0.5);
}

TEST(ArgmaxOdometry, StandsWhereItWasToldNothing) {
  const auto odometry = make("argmax");
  odometry->update(drawn({5, 1, 1, 9, 2, 1, 1, 1}));
  const auto rest = odometry->update(drawn({4, 1, 9, 1, 2, 1, 1, 1}), MotionKind::kRest);
  EXPECT_TRUE(rest.reliable);
  EXPECT_EQ(rest.T_previous_current.x, 0);
  EXPECT_EQ(rest.T_previous_current.phi, 0);
}

TEST(ArgmaxOdometry, ReadsAnArcAlongItsChord) {
  // Half a metre of arc through 20 degrees: the chord lies 10 degrees to the left of the heading.
  const double turn = degToRad(20), radius = 0.5 / turn;
  const Pose2 T{radius * std::sin(turn), radius * (1 - std::cos(turn)), turn};
  const auto before = look(oddRoom(), {0, 0, 0}, {}), after = look(oddRoom(), T, {});
  const auto arc = between("argmax", before, after, MotionKind::kArc);
  // The longest ray is another corner's by some beams after half a metre: the turn is as good as that.
  EXPECT_NEAR(arc.turn_reading_rad, turn, degToRad(6));
  EXPECT_NEAR(std::hypot(arc.T_previous_current.x, arc.T_previous_current.y), 0.5, 0.1);
  EXPECT_NEAR(std::atan2(arc.T_previous_current.y, arc.T_previous_current.x), arc.turn_reading_rad / 2, 1e-9);
}

TEST(ArgmaxBlind, GuessesWhateverItIsTold) {
  const auto before = drawn({5, 1, 1, 9, 2, 1, 1, 1}), after = drawn({4, 1, 9, 1, 3, 1, 1, 1});
  for (const auto kind : {MotionKind::kMove, MotionKind::kTurn, MotionKind::kRest, MotionKind::kArc}) {
    const auto motion = between("argmax_blind", before, after, kind);
    EXPECT_DOUBLE_EQ(motion.turn_reading_rad, kPi / 4);
    EXPECT_EQ(motion.T_previous_current.x, 0);
  }
}

TEST(ArgmaxOdometry, TakesTheFirstOfEqualRangesCountedFromStraightAhead) {
  EXPECT_DOUBLE_EQ(turnSteps({1, 1, 1, 9, 1, 1, 9, 1}, {1, 1, 9, 1, 1, 1, 1, 1}), 1);
  const float inf = lidar::kNoReturn;
  EXPECT_DOUBLE_EQ(turnSteps({1, 1, inf, inf, 1, 1, inf, 1}, {1, inf, inf, 1, 1, inf, 1, 19}), 1);
}

TEST(ArgmaxOdometry, SkipsLostReadings) {
  EXPECT_DOUBLE_EQ(turnSteps({kLost, 1, 1, 9, 1, 1, 1, kLost}, {1, 1, 9, kLost, 1, 1, 1, 1}), 1);
  const std::vector<float> nothing(8, kLost);
  const ScanMotion motion = between("argmax", drawn(nothing), drawn(nothing), MotionKind::kTurn);
  EXPECT_FALSE(motion.reliable);
  EXPECT_EQ(motion.T_previous_current.phi, 0);
}

TEST(ArgmaxOdometry, ReadsAMoveInFrontAndBehind) {
  const ScanMotion motion = between("argmax", drawn({5, 1, 1, 1, 2, 1, 1, 1}),
                                    drawn({4.5, 1, 1, 1, 2.25, 1, 1, 1}), MotionKind::kMove);
  EXPECT_DOUBLE_EQ(motion.front_reading_m, 0.5);         // before minus after: the wall ahead came nearer
  EXPECT_DOUBLE_EQ(motion.rear_reading_m, -0.25);        // and the one behind went away
  EXPECT_DOUBLE_EQ(motion.T_previous_current.x, 0.375);  // their mean, ahead
  EXPECT_EQ(motion.T_previous_current.y, 0);
  EXPECT_EQ(motion.T_previous_current.phi, 0);
  EXPECT_TRUE(motion.reliable);
}

TEST(ArgmaxOdometry, UsesTheOtherReadingWhereOneIsMissingAndSaysSo) {
  const float inf = lidar::kNoReturn;
  const ScanMotion rear_only = between("argmax", drawn({inf, 1, 1, 1, 2, 1, 1, 1}),
                                       drawn({5, 1, 1, 1, 2.5, 1, 1, 1}), MotionKind::kMove);
  EXPECT_DOUBLE_EQ(rear_only.T_previous_current.x, 0.5);
  EXPECT_EQ(rear_only.front_reading_m, 0);
  EXPECT_FALSE(rear_only.reliable);
  const ScanMotion front_only = between("argmax", drawn({5, 1, 1, 1, kLost, 1, 1, 1}),
                                        drawn({4, 1, 1, 1, 2.5, 1, 1, 1}), MotionKind::kMove);
  EXPECT_DOUBLE_EQ(front_only.T_previous_current.x, 1);
  EXPECT_FALSE(front_only.reliable);
  const ScanMotion neither = between("argmax", drawn({5, 1, 1, 1, kLost, 1, 1, 1}),
                                     drawn({inf, 1, 1, 1, 2.5, 1, 1, 1}), MotionKind::kMove);
  EXPECT_EQ(neither.T_previous_current.x, 0);
  EXPECT_FALSE(neither.reliable);
}

TEST(ArgmaxOdometry, WithoutTheCommandTakesAShiftOfTheLongestRangeForATurn) {
  const auto turn = between("argmax", drawn({5, 1, 1, 9, 2, 1, 1, 1}), drawn({4, 1, 9, 1, 2, 1, 1, 1}));
  EXPECT_DOUBLE_EQ(turn.turn_reading_rad, kPi / 4);
  EXPECT_EQ(turn.T_previous_current.x, 0);
  const auto move = between("argmax", drawn({5, 1, 1, 9, 2, 1, 1, 1}), drawn({4, 1, 1, 9, 3, 1, 1, 1}));
  EXPECT_DOUBLE_EQ(move.T_previous_current.x, 1);
  EXPECT_EQ(move.turn_reading_rad, 0);
  // A robot that knows that it moved does not let the longest range mislead it.
  const auto told =
      between("argmax", drawn({5, 1, 1, 9, 2, 1, 1, 1}), drawn({4, 1, 9, 1, 3, 1, 1, 1}), MotionKind::kMove);
  EXPECT_DOUBLE_EQ(told.T_previous_current.x, 1);
}

TEST(ArgmaxOdometry, GivesTheSignsOfARealTurnAndARealMove) {
  const Lidar lidar;  // 1 degree
  const auto before = look(oddRoom(), {0, 0, 0}, lidar);
  for (const double degrees : {1.0, 17.0, 90.0, -3.0, -120.0, 180.0}) {
    const auto motion = between("argmax", before, look(oddRoom(), {0, 0, degToRad(degrees)}, lidar));
    EXPECT_NEAR(motion.T_previous_current.phi, degToRad(degrees), 1e-9) << degrees;
    EXPECT_TRUE(motion.reliable);
  }
  for (const double metres : {0.3, -0.2}) {
    const auto motion = between("argmax", before, look(oddRoom(), {metres, 0, 0}, lidar), MotionKind::kMove);
    EXPECT_NEAR(motion.T_previous_current.x, metres, 1e-6) << "float ranges";
    EXPECT_NEAR(motion.front_reading_m, metres, 1e-6);
    EXPECT_NEAR(motion.rear_reading_m, -metres, 1e-6);
  }
}

TEST(ArgmaxOdometry, UsesTheFrontAloneWhenTheLidarDoesNotLookBack) {
  Lidar lidar;
  lidar.beams = 181, lidar.fov_rad = kPi;
  const auto before = look(oddRoom(), {0, 0, 0}, lidar);
  const auto move = between("argmax", before, look(oddRoom(), {0.3, 0, 0}, lidar), MotionKind::kMove);
  EXPECT_NEAR(move.T_previous_current.x, 0.3, 1e-6);
  EXPECT_EQ(move.rear_reading_m, 0);
  EXPECT_TRUE(move.reliable);
  const auto turn = between("argmax", before, look(oddRoom(), {0, 0, degToRad(-10)}, lidar));
  EXPECT_NEAR(turn.T_previous_current.phi, degToRad(-10), 1e-9);
}

TEST(ArgmaxOdometry, LooksAheadOfTheRobotNotOfATurnedLidar) {
  Lidar lidar;
  lidar.T_robot_lidar = {0, 0, degToRad(90)};
  const auto before = look(oddRoom(), {0, 0, 0}, lidar);
  const auto move = between("argmax", before, look(oddRoom(), {0.3, 0, 0}, lidar), MotionKind::kMove);
  EXPECT_NEAR(move.T_previous_current.x, 0.3, 1e-6);
}

// How the original method breaks, one scene each, and that the improved method copes where the scans allow
// it.

constexpr double kGoodTurn = 0.002;  // 0.1 degree: a tenth of a beam
constexpr double kGoodMove = 0.005;  // half of the smallest motion here that matters

TEST(ArgmaxBreaks, OnTwoNearlyEqualLongestRanges) {
  // Two alcoves opposite each other, 5 m away; a step of 0.2 m makes the other one the longest.
  Scene scene;
  scene.add({{-2, -2},
             {2, -2},
             {2, -0.3},
             {5, -0.3},
             {5, 0.3},
             {2, 0.3},
             {2, 1.5},
             {-2, 2},
             {-2, 0.3},
             {-4.9, 0.3},
             {-4.9, -0.3},
             {-2, -0.3}},
            true);
  const auto before = look(scene, {-0.01, 0, 0}, {});
  const auto after = look(scene, {0.19, 0, 0}, {});
  const auto argmax = between("argmax", before, after);
  EXPECT_GT(std::abs(argmax.T_previous_current.phi), degToRad(150)) << "a half turn that never was";
  const auto correlation = between("correlation", before, after);
  EXPECT_NEAR(correlation.T_previous_current.phi, 0, kGoodTurn);
  EXPECT_NEAR(correlation.T_previous_current.x, 0.2, kGoodMove);
  EXPECT_TRUE(correlation.reliable);
}

TEST(ArgmaxBreaks, InASymmetricRoom) {
  // In the middle of a square, four corners are equally far: after a turn by 50 degrees another one is first.
  const Scene square = Scene().box(-3, -3, 3, 3);
  const auto before = look(square, {0, 0, 0}, {});
  const auto turned = look(square, {0, 0, degToRad(50)}, {});
  EXPECT_NEAR(between("argmax", before, turned).T_previous_current.phi, degToRad(-40), 1e-9);
  // Nothing in the two scans tells 50 from -40 degrees: the improved method has to say so.
  EXPECT_FALSE(between("correlation", before, turned).reliable);
  // But a turn whose rivals lie beyond the search range is told.
  const auto small = between("correlation", before, look(square, {0, 0, degToRad(10)}, {}));
  EXPECT_NEAR(small.T_previous_current.phi, degToRad(10), kGoodTurn);
  EXPECT_TRUE(small.reliable);
}

TEST(ArgmaxBreaks, WhereRangesAreCutAtTheMaximum) {
  // A hall larger than the lidar's reach: all no-returns tie, and straight ahead is one of them before and
  // after.
  Lidar lidar;
  lidar.max_range_m = 8;
  const Scene hall = Scene().box(-3, -4, 40, 40).box(1, 3, 1.5, 4);
  const auto before = look(hall, {0, 0, degToRad(30)}, lidar);
  const auto after = look(hall, {0, 0, degToRad(45)}, lidar);
  EXPECT_EQ(between("argmax", before, after, MotionKind::kTurn).T_previous_current.phi, 0);
  const auto correlation = between("correlation", before, after);
  EXPECT_NEAR(correlation.T_previous_current.phi, degToRad(15), kGoodTurn);
  EXPECT_TRUE(correlation.reliable);
}

TEST(ArgmaxBreaks, WhenTheFrontReadingJumpsThroughADoorway) {
  // The beam ahead hits the wall just beside a doorway; the heading slips by 3 degrees during the move and
  // the beam goes through, 4 m further.
  Scene scene;
  scene.add({{2, 0.03}, {2, -3}, {-3, -3}, {-3, 3.3}, {2, 3.3}, {2, 0.9}});
  scene.add({{2, 0.9}, {6, 0.9}, {6, 0.03}, {2, 0.03}});
  const auto before = look(scene, {0, 0, 0}, {});
  const auto after = look(scene, {0.1, 0, degToRad(3)}, {});
  const auto argmax = between("argmax", before, after, MotionKind::kMove);
  EXPECT_LT(argmax.T_previous_current.x, -1) << "a metre back instead of 0.1 m ahead";
  const auto correlation = between("correlation", before, after);
  EXPECT_NEAR(correlation.T_previous_current.x, 0.1, kGoodMove);
  EXPECT_NEAR(correlation.T_previous_current.phi, degToRad(3), kGoodTurn);
}

TEST(ArgmaxBreaks, OnAMoveThatIsNotAlongTheHeading) {
  const auto before = look(oddRoom(), {0, 0, 0}, {});
  const auto after = look(oddRoom(), {0.1, 0.08, 0}, {});
  const auto argmax = between("argmax", before, after, MotionKind::kMove);
  EXPECT_EQ(argmax.T_previous_current.y, 0) << "it cannot know";
  const auto correlation = between("correlation", before, after);
  EXPECT_NEAR(correlation.T_previous_current.x, 0.1, kGoodMove);
  EXPECT_NEAR(correlation.T_previous_current.y, 0.08, kGoodMove);
}

TEST(ArgmaxBreaks, OnATurnOfLessThanOneBeam) {
  const auto before = look(oddRoom(), {0, 0, 0}, {});
  const auto after = look(oddRoom(), {0, 0, degToRad(0.4)}, {});
  const double read = between("argmax", before, after, MotionKind::kTurn).T_previous_current.phi;
  EXPECT_TRUE(read == 0 || std::abs(read - degToRad(1)) < 1e-9) << "whole beams only: " << read;
  EXPECT_NEAR(between("correlation", before, after).T_previous_current.phi, degToRad(0.4), degToRad(0.02))
      << "a fiftieth of a beam";
}

TEST(ArgmaxBreaks, UnderRangeNoise) {
  // Half a metre of wall is equally far to within the noise, so the longest range wanders over it.
  Lidar lidar;
  lidar.sigma_m = 0.03;
  core::RandomStream random(1, "lidar");
  const Scene scene = oddRoom();
  double argmax_squares = 0, correlation_squares = 0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    const auto before = look(scene, {0.4, 0.3, 0}, lidar, &random);
    const auto after = look(scene, {0.4, 0.3, degToRad(5)}, lidar, &random);
    const auto squaredError = [&](const char* method) {
      const double phi = between(method, before, after, MotionKind::kTurn).T_previous_current.phi;
      return std::pow(core::angleDifference(phi, degToRad(5)), 2);
    };
    argmax_squares += squaredError("argmax");
    correlation_squares += squaredError("correlation");
  }
  EXPECT_GT(std::sqrt(argmax_squares / kRuns), degToRad(0.3));
  // Its own covariance says 0.1 degree.
  EXPECT_LT(std::sqrt(correlation_squares / kRuns), degToRad(0.2));
}

}  // namespace
}  // namespace slam::odometry
