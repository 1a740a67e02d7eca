// The numbers that the original document gives for motion, exploration and goal navigation, each at its
// border.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libslam/core/error.h"
#include "libslam/goals/lidar_bug.h"
#include "libslam/navigate/driver.h"
#include "libslam/safety/free_ways.h"
#include "libslam/safety/safe_motion.h"
#include "libslam/safety/view.h"
#include "libslam/strategies/strategy.h"
#include "tests/navigate/goal_scenes.h"
#include "tests/navigate/scenes.h"

namespace slam::navigate {
namespace {

using core::degToRad;
using core::radToDeg;

/// A original scan: N readings once round, reading 0 straight ahead, indices growing to the left.
lidar::Scan originalScan(std::vector<float> ranges_m) {
  lidar::Scan scan;
  scan.first_angle_rad = 0;
  scan.step_rad = 2 * core::kPi / static_cast<double>(ranges_m.size());
  scan.max_range_m = 50;
  scan.ranges_m = std::move(ranges_m);
  return scan;
}

lidar::Scan originalScan(size_t readings, float everywhere_m,
                         const std::vector<std::pair<size_t, float>>& other) {
  std::vector<float> ranges_m(readings, everywhere_m);
  for (const auto& [index, range_m] : other) ranges_m[index] = range_m;
  return originalScan(std::move(ranges_m));
}

// First and last eighth ahead, 3/8 to 5/8 behind: of 800 readings 0..100 and 700..799, and 300..500.
TEST(OriginalCanMove, HasItsSectorsAtEighthsOfTheScan) {
  const auto blockedBy = [](size_t index) {
    return safety::canMove(originalScan(800, 5, {{index, 0.4F}}), 0.5);
  };
  for (const size_t front : {0, 1, 99, 100, 700, 701, 799})
    EXPECT_EQ(blockedBy(front), safety::FreeWays::kRearOnly) << front;
  for (const size_t rear : {300, 301, 400, 499, 500})
    EXPECT_EQ(blockedBy(rear), safety::FreeWays::kFrontOnly) << rear;
  for (const size_t aside : {101, 200, 299, 501, 600, 699})
    EXPECT_EQ(blockedBy(aside), safety::FreeWays::kBoth) << aside;
}

TEST(OriginalCanMove, AnswersWithTheNumbersZeroToThree) {
  const auto answer = [](const std::vector<std::pair<size_t, float>>& near) {
    return static_cast<int>(safety::canMove(originalScan(360, 5, near), 0.5));
  };
  EXPECT_EQ(answer({}), 0);                            // both free
  EXPECT_EQ(answer({{180, 0.499F}}), 1);               // only front
  EXPECT_EQ(answer({{0, 0.499F}}), 2);                 // only rear
  EXPECT_EQ(answer({{0, 0.499F}, {180, 0.499F}}), 3);  // neither
  EXPECT_EQ(answer({{0, 0.5F}, {180, 0.5F}}), 0) << "blocked below w, not at it";
}

TEST(OriginalCanMove, TakesWFromTheRobotsCircleAndItsStep) {
  robot::RobotOptions robot;
  EXPECT_NEAR(safety::stopClearance(robot, 0.2, 0.01), 0.2 * std::sqrt(2) + 0.1 + 0.02 + 0.01, 1e-12);
  robot.max_speed_mps = 1;
  EXPECT_NEAR(safety::stopClearance(robot, 0.2, 0.01), 0.2 * std::sqrt(2) + 0.2 + 0.02 + 0.01, 1e-12);
}

// What w promises: one whole step into any direction of the free sector, and the circle still has its margin.
TEST(OriginalCanMove, WithThatWAStepIntoTheSectorKeepsTheMargin) {
  const robot::RobotOptions robot;
  const double w_m = safety::stopClearance(robot, 0.2, 0), step_m = robot.max_speed_mps * 0.2;
  for (int wall = -45; wall <= 45; wall += 5) {
    auto scan = originalScan(360, 20, {{static_cast<size_t>((wall + 360) % 360), static_cast<float>(w_m)}});
    ASSERT_EQ(safety::canMove(scan, w_m - 1e-6), safety::FreeWays::kBoth);
    for (int drive = -45; drive <= 45; drive += 5)
      EXPECT_GE(safety::discReach(scan, degToRad(drive), robot), step_m - 1e-6) << wall << " " << drive;
  }
}

TEST(OriginalCanMove, StopsTheDriverAtTheWThatFollowsFromTheRobot) {
  // The return ahead stands between the w that follows, 0.413 m, and the default of 0.45 m.
  const auto scan = [] {
    auto seen = originalScan(360, 8, {{30, 0.43F}});
    seen.range_sigma_m = 0.01;
    return seen;
  }();
  strategies::StrategyOptions options;
  options.name = "longest_ray";
  const auto speed = [&](double w_m) {
    options.stop_clearance_m = w_m;
    Driver driver(strategies::makeStrategy(options, {1, "s"}), options, {}, 0.2, {1, "driver"});
    return driver.next(scan, {}, false).speed_mps;
  };
  EXPECT_LE(speed(0.45), 0);
  EXPECT_GT(speed(0), 0);
}

TEST(OriginalDivisor, IsFromATenthToTwo) {
  const strategies::StrategyOptions options;
  EXPECT_EQ(options.divisor_min, 0.1);
  EXPECT_EQ(options.divisor_max, 2.0);
}

TEST(OriginalQuadrants, AreNinetyDegreesEachFromTheHeading) {
  const std::vector<std::pair<double, int>> borders = {{0, 0},     {89.9, 0}, {90, 1},    {179.9, 1},
                                                       {180.1, 2}, {269, 2},  {270.1, 3}, {359.9, 3}};
  for (const auto& [degrees, quadrant] : borders)
    EXPECT_EQ(safety::quadrantOf(degToRad(degrees)), quadrant) << degrees;
}

TEST(OriginalQuadrants, DoNotChooseWhatLeadsBackWithin45Degrees) {
  for (const int aside : {0, 30, 44, 46, 60}) {
    strategies::StrategyOptions options;
    options.divisor_min = options.divisor_max = 1;
    const auto strategy = strategies::makeStrategy(options, {1, "s"});
    strategy->decide(originalScan(360, 3, {}), {0, 0, 0});
    // Came straight ahead: the way back is at 180 degrees. The longest ray is so far aside of it.
    const auto scan = originalScan(360, 1, {{static_cast<size_t>(180 - aside), 9.0F}, {20, 4.0F}});
    const double chosen_deg = radToDeg(strategy->decide(scan, {3, 0, 0}).turn_rad);
    EXPECT_NEAR(chosen_deg, aside <= 45 ? 20 : 180 - aside, 1e-9) << aside;
  }
}

/// A robot that fits into the 0.22 m, as configs/navigate/thesis.ini has it.
robot::RobotOptions smallRobot() {
  robot::RobotOptions robot;
  robot.side_m = 0.22;
  return robot;
}

/// One look of a bug that drives towards a goal 10 m ahead.
goals::GoalStep look(const lidar::Scan& scan, const robot::RobotOptions& robot = smallRobot(),
                     const goals::NavigateOptions& options = {}) {
  const auto bug = goals::makeGoalNavigator("lidar_bug", options, {{10, 0}, robot, 0.2});
  bug->next(originalScan(275, 5, {}), {}, false);
  return bug->next(scan, {}, false);
}

TEST(OriginalBug, StopsForWhatIsNearerThan22Centimetres) {
  const goals::LidarBugOptions options;
  EXPECT_EQ(options.stop_radius_m, 0.22);
  EXPECT_EQ(look(originalScan(275, 5, {{80, 0.219F}})).state, "STUCK LEAVE");
  EXPECT_EQ(look(originalScan(275, 5, {{80, 0.221F}})).state, "DRIVE FORWARD");
}

TEST(OriginalBug, StopsEarlierWhereTheRobotsCircleDoesNotFit) {
  const robot::RobotOptions robot;  // 0.4 m square
  const double guard_m = 0.2 * std::sqrt(2) + 0.02;
  EXPECT_DOUBLE_EQ(goals::lidarBugStopRadius({}, guard_m), guard_m + 0.03);
  EXPECT_DOUBLE_EQ(goals::lidarBugStopRadius({}, 0.18), 0.22);
  EXPECT_EQ(look(originalScan(275, 5, {{80, 0.332F}}), robot).state, "STUCK LEAVE");
  EXPECT_EQ(look(originalScan(275, 5, {{80, 0.334F}}), robot).state, "DRIVE FORWARD");
}

TEST(OriginalBug, TakesReadingsBelowACentimetreAsInvalidAndFromThereOnAsABump) {
  EXPECT_EQ(goals::LidarBugOptions().invalid_below_m, 0.01);
  EXPECT_EQ(look(originalScan(275, 5, {{80, 0.0099F}})).state, "DRIVE FORWARD");
  EXPECT_EQ(look(originalScan(275, 5, {{80, 0.0101F}})).state, "STUCK LEAVE");
}

TEST(OriginalBug, CallsABumpInFrontWithin92Degrees) {
  // Of 275 readings 70 lies at 91.6 and 71 at 92.9 degrees, 205 and 204 the same on the right.
  const auto bump = [](size_t index) {
    const auto step = look(originalScan(275, 5, {{index, 0.15F}}));
    return step.changes.empty() ? "no bump" : step.changes.front().why;
  };
  for (const size_t front : {1, 70, 205, 274})
    EXPECT_THAT(bump(front), testing::HasSubstr("in front")) << front;
  for (const size_t behind : {71, 137, 204})
    EXPECT_THAT(bump(behind), testing::HasSubstr("behind")) << behind;
}

// Indices 0, 28, 68, 207, 247 of 275: every one of them is read, its neighbours are not.
TEST(OriginalBug, ReadsTheFiveIndicesAndProjectsThePlaceReachedThatWay) {
  const std::vector<size_t> indices = {0, 28, 68, 207, 247};
  for (size_t d = 0; d < indices.size(); ++d) {
    const auto step = look(originalScan(
        275, 5, {{indices[d], 1.25F}, {indices[d] + 1, 1.0F}, {(indices[d] + 274) % 275, 1.0F}}));
    ASSERT_EQ(step.p_robot_projected.size(), 5U);
    const double angle_rad = 2 * core::kPi * static_cast<double>(indices[d]) / 275;
    EXPECT_NEAR(step.p_robot_projected[d].x, 1.25 * std::cos(angle_rad), 1e-6) << d;
    EXPECT_NEAR(step.p_robot_projected[d].y, 1.25 * std::sin(angle_rad), 1e-6) << d;
    for (size_t other = 0; other < 5; ++other) {
      if (other == d) continue;
      const auto& p = step.p_robot_projected[other];
      EXPECT_NEAR(std::hypot(p.x, p.y), 1.6, 1e-6) << "capped at one stride, twice clear_front_m";
    }
  }
}

TEST(OriginalBug, DrivesAtAGoalThatIsNearWhateverStandsBesideAndStopsThere) {
  const auto beside = originalScan(275, 5, {{68, 0.3F}});
  for (const double goal_m : {0.7, 0.9}) {  // near_goal_m is 0.8
    const auto bug = goals::makeGoalNavigator("lidar_bug", {}, {{goal_m, 0}, smallRobot(), 0.2});
    EXPECT_EQ(bug->next(beside, {}, false).state == "DRIVE AT GOAL", goal_m < 0.8);
    const auto there = bug->next(beside, {goal_m - 0.05, 0, 0}, false);
    EXPECT_EQ(there.state, "REACHED");
    EXPECT_EQ(there.command.speed_mps, 0);
  }
}

TEST(OriginalBug, TellsEveryTransitionOfAPeriod) {
  const auto bug = goals::makeGoalNavigator("lidar_bug", {}, {{10, 0}, smallRobot(), 0.2});
  // Faces the goal with something before it: two transitions at the first look.
  const auto step = bug->next(originalScan(275, 5, {{0, 0.5F}}), {}, false);
  ASSERT_EQ(step.changes.size(), 2U);
  EXPECT_EQ(step.changes[0].from, "TURN TO GOAL");
  EXPECT_EQ(step.changes[0].to, "DRIVE FORWARD");
  EXPECT_EQ(step.changes[1].from, "DRIVE FORWARD");
  EXPECT_EQ(step.changes[1].to, "AVOID TURN");
  EXPECT_EQ(step.changes[1].why, "obstacle in range");
  EXPECT_EQ(step.state, "AVOID TURN");
  EXPECT_TRUE(bug->next(originalScan(275, 5, {{0, 0.5F}}), {}, false).changes.empty());
  // Nothing is told twice where it only waits for a valid reading.
  bug->next(originalScan(275, 5, {}), {0, 0, 1}, false);
  EXPECT_TRUE(bug->next(originalScan(275, lidar::kLostReading, {}), {0, 0, 1}, false).changes.empty());
}

/// Brings a bug to its wall's end with the goal far aside, and looks once more.
goals::GoalStep atTheWallsEnd(const std::string& wall_end) {
  goals::NavigateOptions options;
  options.lidar_bug.wall_end = wall_end;
  const auto bug = goals::makeGoalNavigator("lidar_bug", options, {{10, 0}, smallRobot(), 0.2});
  const auto wall = originalScan(275, 5, {{206, 0.4F}, {207, 0.4F}, {208, 0.4F}});
  bug->next(originalScan(275, 5, {{0, 0.5F}, {207, 0.35F}}), {}, false);
  bug->next(wall, {0, 0, 1.5}, false);
  EXPECT_EQ(bug->next(wall, {0.02, 0.45, 1.5}, false).state, "WALL FOLLOW");
  return bug->next(originalScan(275, 5, {}), {0.02, 0.55, 1.5}, false);
}

TEST(OriginalBug, DrivesOnWhereTheWallEndsAsSoonAsTheFrontIsClear) {
  const auto original = atTheWallsEnd("front");
  EXPECT_EQ(original.state, "OPEN DRIVE");
  EXPECT_GT(original.command.speed_mps, 0);
  ASSERT_EQ(original.changes.size(), 2U);
  EXPECT_EQ(original.changes[0].to, "OPEN TURN");
  const auto ours = atTheWallsEnd("goal");  // turns on, to the goal's side
  EXPECT_EQ(ours.state, "OPEN TURN");
  EXPECT_LT(ours.command.turn_rate_radps, 0);
}

TEST(OriginalBug, StillPassesWhatTheDefaultPasses) {
  goals::NavigateOptions options;
  options.lidar_bug.wall_end = "front";
  const auto drive =
      scenes::driveTo(scenes::pillar(), "lidar_bug", scenes::exactLidar(), scenes::exactOdometry(), options);
  EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
  EXPECT_EQ(drive.collisions, 0U);
}

}  // namespace
}  // namespace slam::navigate
