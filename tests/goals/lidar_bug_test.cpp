#include "libslam/goals/lidar_bug.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <set>

#include "libslam/files/files.h"
#include "tests/navigate/goal_scenes.h"

namespace slam::navigate {
namespace {

using State = goals::LidarBugState;
using Event = goals::LidarBugEvent;
using namespace scenes;

bool isEnd(State state) {
  return state == State::kReached || state == State::kGaveUp;
}

TEST(LidarBugTable, HasOneRowPerStateAndEvent) {
  std::set<std::pair<State, Event>> seen;
  for (const auto& row : goals::lidarBugTransitions())
    EXPECT_TRUE(seen.insert({row.from, row.event}).second)
        << goals::lidarBugStateName(row.from) << ", " << goals::lidarBugEventName(row.event);
}

TEST(LidarBugTable, ReachesEveryStateAndLeavesAllButTheTwoEnds) {
  std::set<State> reached{State::kTurnToGoal};
  for (int rounds = 0; rounds < goals::kLidarBugStates; ++rounds)
    for (const auto& row : goals::lidarBugTransitions())
      if (reached.count(row.from)) reached.insert(row.to);
  EXPECT_EQ(reached.size(), static_cast<size_t>(goals::kLidarBugStates));
  for (int i = 0; i < goals::kLidarBugStates; ++i) {
    const auto state = static_cast<State>(i);
    std::set<Event> events;
    for (const auto& row : goals::lidarBugTransitions())
      if (row.from == state) events.insert(row.event);
    EXPECT_EQ(events.count(Event::kGoalReached), isEnd(state) ? 0U : 1U) << goals::lidarBugStateName(state);
    EXPECT_EQ(events.count(Event::kEnded), isEnd(state) ? 0U : 1U) << goals::lidarBugStateName(state);
    EXPECT_EQ(events.empty(), isEnd(state));
  }
}

TEST(LidarBugTable, NamesEveryStateAndEventOnce) {
  std::set<std::string> names;
  for (int i = 0; i < goals::kLidarBugStates; ++i)
    names.insert(goals::lidarBugStateName(static_cast<State>(i)));
  EXPECT_EQ(names.size(), static_cast<size_t>(goals::kLidarBugStates));
  std::set<std::string> events;
  for (const auto& row : goals::lidarBugTransitions()) events.insert(goals::lidarBugEventName(row.event));
  EXPECT_EQ(events.size(), static_cast<size_t>(Event::kEnded) + 1);
}

// The committed picture is made from the table; when this fails, the new one lies beside the test's program.
TEST(LidarBugTable, IsTheDiagramInTheDocumentation) {
  const std::string path = std::string(RASTERSLAM_SOURCE_DIR) + "/libslam/goals/lidar_bug.md";
  std::string committed;
  try {
    committed = files::readTextFile(path);
  } catch (const std::exception&) {
  }
  if (committed != goals::lidarBugDiagram())
    files::writeFileAtomically(std::string(RASTERSLAM_BINARY_DIR) + "/lidar_bug.md",
                               goals::lidarBugDiagram());
  EXPECT_EQ(committed, goals::lidarBugDiagram());
}

// Indices 0, 28, 68, 207, 247 of 275 readings over 360 degrees; those above the half turn lie on the right.
TEST(StrategicDirections, AreTheOriginalOnes) {
  const auto directions = goals::strategicDirections();
  EXPECT_EQ(directions[goals::kAhead], 0);
  EXPECT_NEAR(core::radToDeg(directions[goals::kLeftAhead]), 37, 0.5);  // 36.65: the document rounds
  EXPECT_NEAR(core::radToDeg(directions[goals::kLeft]), 89, 0.1);
  EXPECT_NEAR(core::radToDeg(directions[goals::kRight]), -89, 0.1);
  EXPECT_NEAR(core::radToDeg(directions[goals::kRightAhead]), -37, 0.5);
}

/// A circle of one-degree beams at 5 m with obstacles at given angles (degrees).
lidar::Scan scanWith(const std::vector<std::pair<int, float>>& obstacles) {
  lidar::Scan scan;
  scan.first_angle_rad = -core::kPi;
  scan.step_rad = core::kPi / 180;
  scan.max_range_m = 6;
  scan.ranges_m.assign(360, 5.0F);
  for (const auto& [degrees, range_m] : obstacles)
    for (int aside = -3; aside <= 3; ++aside) scan.ranges_m[(degrees + aside + 180 + 360) % 360] = range_m;
  return scan;
}

/// Shows one scan after another at one place; returns the states.
class Shown {
 public:
  Shown() : navigator_(goals::makeGoalNavigator("lidar_bug", {}, {{10, 0}, robot::RobotOptions(), 0.2})) {}
  std::string show(const lidar::Scan& scan, const core::Pose2& T_odom_robot) {
    step_ = navigator_->next(scan, T_odom_robot, false);
    return step_.state;
  }
  const goals::GoalStep& step() const { return step_; }

 private:
  std::unique_ptr<goals::GoalNavigator> navigator_;
  goals::GoalStep step_;
};

TEST(LidarBug, TurnsToTheGoalAndDrives) {
  Shown bug;
  EXPECT_EQ(bug.show(scanWith({}), {0, 0, 1}), "TURN TO GOAL");
  EXPECT_LT(bug.step().command.turn_rate_radps, 0);
  EXPECT_EQ(bug.step().command.speed_mps, 0);
  EXPECT_EQ(bug.show(scanWith({}), {0, 0, 0}), "DRIVE FORWARD");
  EXPECT_GT(bug.step().command.speed_mps, 0);
  EXPECT_EQ(bug.step().reason, "faces the goal");
}

TEST(LidarBug, AvoidsWhatIsAheadOnTheSideWithRoom) {
  Shown bug;
  // Ahead within 0.6 m, and the right side taken.
  EXPECT_EQ(bug.show(scanWith({{0, 0.55F}, {-89, 0.38F}}), {}), "AVOID TURN");
  EXPECT_EQ(bug.step().command.speed_mps, 0);
  EXPECT_GT(bug.step().command.turn_rate_radps, 0);
  EXPECT_EQ(bug.show(scanWith({{-89, 0.5F}}), {0, 0, 1.5}), "AVOID DRIVE");
  EXPECT_EQ(bug.show(scanWith({{-89, 0.5F}}), {0.02, 0.45, 1.5}), "WALL FOLLOW");
  EXPECT_EQ(bug.show(scanWith({}), {0.02, 0.55, 1.5}), "OPEN TURN");
  EXPECT_LT(bug.step().command.turn_rate_radps, 0);
  EXPECT_EQ(bug.show(scanWith({}), {0.02, 0.55, -0.05}), "OPEN DRIVE");
  EXPECT_EQ(bug.show(scanWith({}), {0.45, 0.55, 0.5}), "TURN TO GOAL");
}

TEST(LidarBug, KeepsTheWallsDistanceByTurning) {
  for (const double side : {1.0, -1.0}) {
    Shown bug;
    const int degrees = static_cast<int>(89 * side), oblique = static_cast<int>(37 * side);
    const auto parallel = [&](float range_m) {
      return scanWith({{degrees, range_m}, {oblique, range_m / 0.6F}});
    };
    bug.show(scanWith({{0, 0.55F}, {degrees, 0.38F}}), {});
    bug.show(parallel(0.5F), {0, 0, -side});
    ASSERT_EQ(bug.show(parallel(0.45F), {0.3, -0.4 * side, -side}), "WALL FOLLOW");
    EXPECT_LT(bug.step().command.turn_rate_radps * side, 0) << "too near: away from the wall";
    ASSERT_EQ(bug.show(parallel(0.7F), {0.35, -0.45 * side, -side}), "WALL FOLLOW");
    EXPECT_GT(bug.step().command.turn_rate_radps * side, 0) << "too far: towards the wall";
  }
}

TEST(LidarBug, BacksOffFromABumpInFrontAndAdvancesFromOneBehind) {
  for (const int degrees : {30, 85, -85, 99, 150, -150, -99}) {
    Shown bug;
    bug.show(scanWith({}), {});
    EXPECT_EQ(bug.show(scanWith({{degrees, 0.32F}}), {}), "STUCK LEAVE") << degrees;
    const bool in_front = std::abs(degrees) <= 92;
    EXPECT_EQ(bug.step().command.speed_mps < 0, in_front) << degrees;
    EXPECT_THAT(bug.step().reason, ::testing::HasSubstr(in_front ? "in front" : "behind"));
  }
}

TEST(LidarBug, TakesReadingsUnderACentimetreAsInvalid) {
  Shown bug;
  EXPECT_EQ(bug.show(scanWith({{0, 0.005F}}), {}), "DRIVE FORWARD");
}

TEST(LidarBug, ClearsTheFrontAfterSeveralBumpsInARow) {
  Shown bug;
  const auto bump = scanWith({{20, 0.32F}});
  std::string state = bug.show(scanWith({}), {});
  core::Pose2 T_odom_robot;
  int leaves = 0;
  std::string last;
  for (int i = 0; i < 40 && state != "STUCK CLEAR"; ++i) {
    T_odom_robot = T_odom_robot * robot::driveMotion(bug.step().command);
    state = bug.show(state == "STUCK LEAVE" || state == "STUCK TURN" ? scanWith({}) : bump, T_odom_robot);
    leaves += state == "STUCK LEAVE" && last != "STUCK LEAVE";
    last = state;
  }
  EXPECT_EQ(state, "STUCK CLEAR");
  EXPECT_EQ(leaves, 2);  // the third bump in a row
  EXPECT_EQ(bug.show(scanWith({}), T_odom_robot), "AVOID DRIVE");
}

TEST(LidarBug, RecoversFromBeingMovedByTurningToTheGoalAgain) {
  Shown bug;
  EXPECT_EQ(bug.show(scanWith({}), {}), "DRIVE FORWARD");
  EXPECT_EQ(bug.show(scanWith({}), {4, 3, 2}), "TURN TO GOAL");
}

TEST(LidarBug, PassesAPillarAndTwoDoorsAndCirclesInATrap) {
  for (const auto& scene : {pillar(), doors(), pillars()}) {
    const auto drive = driveTo(scene, "lidar_bug", exactLidar(), exactOdometry());
    EXPECT_EQ(drive.status, goals::GoalStatus::kReached) << drive.reason;
    EXPECT_EQ(drive.collisions, 0U);
  }
  goals::NavigateOptions options;
  options.time_limit_s = 300;
  const auto drive = driveTo(trap(), "lidar_bug", exactLidar(), exactOdometry(), options);
  EXPECT_EQ(drive.status, goals::GoalStatus::kGaveUp);  // the way it breaks: no memory of having been here
  EXPECT_THAT(drive.states, ::testing::Contains("WALL FOLLOW"));
}

}  // namespace
}  // namespace slam::navigate
