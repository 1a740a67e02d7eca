#include "libslam/reach/reach_goal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/goals/lidar_bug.h"
#include "libslam/goals/surroundings.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/testing/temp_folder.h"

namespace slam::reach {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A room of 5 x 3 m, with a closed box of 1.2 m outside in its right half when asked.
ReachGoalRequest roomRequest(const std::string& output, bool with_box) {
  ReachGoalRequest request;
  auto& plan = request.plan;
  plan.name = "room";
  plan.columns = 100;
  plan.rows = 60;
  plan.cells.assign(6000, world::Cell::kFree);
  const auto wall = [&](int x0, int y0, int x1, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = x0; x < x1; ++x) plan.cells[static_cast<size_t>(y) * 100 + x] = world::Cell::kOccupied;
  };
  wall(0, 0, 100, 1), wall(0, 59, 100, 60), wall(0, 0, 1, 60), wall(99, 0, 100, 60);
  if (with_box) wall(58, 18, 82, 19), wall(58, 41, 82, 42), wall(58, 18, 59, 42), wall(81, 18, 82, 42);
  request.T_world_start = {1, 1.5, 0.5};
  request.p_world_goal = {3.5, 1.5};
  files::IniFile ini;
  ini.set("lidar", "beams", "181", "test");
  request.config = readReachGoalConfig(ini);
  request.methods = {"bug2", "tangent"};
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = output;
  return request;
}

/// Gives up at once.
class Quitter : public goals::GoalNavigator {
 public:
  goals::GoalStep next(const lidar::Scan& /*scan*/, const core::Pose2& /*T_odom_robot*/,
                       bool /*collided*/) override {
    return {{}, goals::GoalStatus::kGaveUp, "gave up", "too far"};
  }
};

TEST(ReachGoal, TakesANavigatorFromOutside) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", false);
  request.own = {{"quitter", [](const goals::NavigateOptions&, const goals::GoalTask&) {
                    return std::make_unique<Quitter>();
                  }}};
  request.methods = {"quitter", "tangent"};
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  ASSERT_EQ(comparison.runs.size(), 2U);
  EXPECT_EQ(comparison.runs[0].reason, "too far");
  EXPECT_FALSE(comparison.runs[0].right);
  EXPECT_TRUE(comparison.runs[1].right);
  EXPECT_TRUE(fs::exists(folder / "out/quitter/states.csv"));
  request.methods = {"quiter"};
  EXPECT_THROW(reachGoal(request, {}, core::silentProgress()), core::InputError);
}

TEST(ReachGoal, RecordsALogWithItsTruthForEveryMethod) {
  const testing::TempFolder folder;
  const auto request = roomRequest(folder / "out", false);
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  for (const auto& run : comparison.runs) {
    const std::string stem = folder / ("out/" + run.method + "/run");
    logs::LogReader log(stem + ".rawlog");
    size_t scans = 0;
    while (log.next()) ++scans;
    EXPECT_EQ(scans, run.truth.size());
    EXPECT_EQ(files::readTextFile(stem + ".gt.tum"),
              files::readTextFile(folder / ("out/" + run.method + "/truth.tum")));
    for (const std::string ending : {".rawlog.GT.txt", ".operations.txt", ".manifest.json"})
      EXPECT_TRUE(fs::exists(stem + ending)) << ending;
    EXPECT_FALSE(fs::exists(stem + ".carries.csv"));
  }
}

TEST(ReachGoal, ACarriedRobotDoesNotKnowAndTheTruthDoes) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", false);
  request.methods = {"tangent"};
  request.config.carries = sim::parseCarries("2:1,0.6,0", "test");
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  const auto& run = comparison.runs.at(0);
  ASSERT_EQ(run.carries.size(), 1U);
  EXPECT_EQ(run.status, goals::GoalStatus::kReached);  // by its wheels
  EXPECT_FALSE(run.right);                             // but not truly
  EXPECT_LT(run.path_m, core::pathLength(run.truth) - 0.5);
  EXPECT_THAT(table::toText(comparison.table), HasSubstr("tangent: kidnapped at 2.0 s from"));
  EXPECT_TRUE(fs::exists(folder / "out/tangent/run.carries.csv"));
}

TEST(ReachGoal, ACarryAfterTheEndIsSaid) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", false);
  request.methods = {"tangent"};
  request.config.carries = sim::parseCarries("300:1,0.6,0", "test");
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  EXPECT_THAT(table::toText(comparison.table), HasSubstr("1 of the carries came after the end"));
}

TEST(ReachGoal, WritesPathsStatesPicturesAndTheTable) {
  const testing::TempFolder folder;
  const auto request = roomRequest(folder / "out", false);
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.wrong, 0);
  ASSERT_TRUE(comparison.shortest_m.has_value());
  EXPECT_NEAR(*comparison.shortest_m, 2.45, 0.06);  // ends within 0.1 m, at the centre of a cell
  for (const auto& run : comparison.runs) {
    EXPECT_EQ(run.status, goals::GoalStatus::kReached);
    EXPECT_EQ(run.collisions, 0U);
    EXPECT_EQ(run.truth.size(), run.estimate.size());
    EXPECT_EQ(logs::readTum(folder / ("out/" + run.method + "/truth.tum")).size(), run.truth.size());
    EXPECT_THAT(files::readTextFile(folder / ("out/" + run.method + "/states.csv")),
                ::testing::StartsWith("time_s,from,to,why,x_m,y_m\r\n0,,to goal,start,1,1.5\r\n"));
    EXPECT_TRUE(fs::exists(folder / ("out/" + run.method + "/path.png")));
  }
  for (const std::string name :
       {"paths.png", "scores.txt", "scores.md", "scores.tex", "scores.csv", "scores.json", "manifest.json"})
    EXPECT_TRUE(fs::exists(folder / ("out/" + name))) << name;
}

TEST(ReachGoal, WritesEveryTransitionOfTheOriginalBugAndWhereItsFiveDirectionsLead) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", true);
  request.p_world_goal = {4.6, 1.5};  // behind the box
  request.methods = {"lidar_bug"};
  request.config.navigate.time_limit_s = 60;
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  const auto& changes = comparison.runs[0].changes;
  ASSERT_GT(changes.size(), 5U);
  EXPECT_EQ(changes.front().from, "");
  EXPECT_EQ(changes.front().to, "TURN TO GOAL");
  size_t within_a_period = 0;
  for (size_t i = 1; i < changes.size(); ++i) {
    EXPECT_EQ(changes[i].from, changes[i - 1].to);
    const auto& rows = goals::lidarBugTransitions();
    EXPECT_TRUE(std::any_of(rows.begin(), rows.end(),
                            [&](const auto& row) {
                              return goals::lidarBugStateName(row.from) == changes[i].from &&
                                     goals::lidarBugStateName(row.to) == changes[i].to;
                            }))
        << changes[i].from << " to " << changes[i].to << ": a transition is missing between them";
    within_a_period += changes[i].time_s == changes[i - 1].time_s;
    for (const auto& p : changes[i].p_world_projected)
      EXPECT_LE(core::distance(p, changes[i].p_world), 1.6 + 1e-9) << "one stride";
  }
  EXPECT_GT(within_a_period, 0U);
  EXPECT_THAT(
      files::readTextFile(folder / "out/lidar_bug/states.csv"),
      ::testing::StartsWith("time_s,from,to,why,x_m,y_m,ahead_x_m,ahead_y_m,left_ahead_x_m,left_ahead_y_m,"
                            "left_x_m,left_y_m,right_x_m,right_y_m,right_ahead_x_m,right_ahead_y_m\r\n"));
}

TEST(ReachGoal, HasTheOriginalNavigationToTheLetterAmongTheConfigurations) {
  const auto config =
      readReachGoalConfig(resources::readConfigFile(resources::configsFolder() + "/navigate/thesis.ini"));
  EXPECT_EQ(config.navigate.lidar_bug.wall_end, "front");
  EXPECT_EQ(config.lidar.beams, 275);
  const goals::Surroundings keeps(config.robot, config.navigate.clearance_m, 0.2);
  EXPECT_EQ(goals::lidarBugStopRadius(config.navigate.lidar_bug, keeps.guardRadius() + config.lidar.sigma_m),
            0.22);
}

TEST(ReachGoal, DrivesByTheLocalObstacleMapWhenAsked) {
  const testing::TempFolder folder;
  files::IniFile ini;
  for (const auto& [section, key, value] :
       std::vector<std::array<std::string, 3>>{{"navigate", "memory", "local_map"},
                                               {"obstacles", "width_m", "3"},
                                               {"lidar", "fov_deg", "120"},
                                               {"lidar", "beams", "121"}})
    ini.set(section, key, value, "test");
  auto request = roomRequest(folder / "out", true);
  request.config = readReachGoalConfig(ini);
  EXPECT_EQ(request.config.navigate.obstacles.width_m, 3);
  request.p_world_goal = {4.6, 0.5};
  request.methods = {"tangent"};
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.wrong, 0) << comparison.runs[0].reason;
  EXPECT_EQ(comparison.runs[0].collisions, 0U);
}

TEST(ReachGoal, IsRightWhenItSaysThatNoWayLeadsThere) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", true);
  request.methods = {"bug1", "bug2", "tangent"};
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  EXPECT_FALSE(comparison.shortest_m.has_value());
  EXPECT_EQ(comparison.wrong, 0);
  for (const auto& run : comparison.runs) EXPECT_EQ(run.status, goals::GoalStatus::kUnreachable);
  EXPECT_THAT(table::toText(comparison.table), HasSubstr("No way of the disc"));
}

TEST(ReachGoal, CountsAMethodThatGaveUpAsWrong) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", false);
  request.methods = {"bug1"};
  request.config.navigate.time_limit_s = 1;
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.wrong, 1);
  EXPECT_EQ(comparison.runs[0].status, goals::GoalStatus::kGaveUp);
}

TEST(ReachGoal, DrivesByThePoseOfASlamMethod) {
  const testing::TempFolder folder;
  auto request = roomRequest(folder / "out", true);
  request.p_world_goal = {4.6, 0.5};
  request.methods = {"tangent"};
  request.slam = "naive_correlation";
  const auto comparison = reachGoal(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.wrong, 0) << comparison.runs[0].reason;
  request.slam = "icq";
  request.overwrite = true;
  EXPECT_THROW(reachGoal(request, {}, core::silentProgress()), core::InputError);
}

TEST(ReachGoal, GivesTheSameBytesForTheSameRequest) {
  const testing::TempFolder folder;
  std::string bytes[2];
  for (int i = 0; i < 2; ++i) {
    const std::string output = folder / ("out" + std::to_string(i));
    reachGoal(roomRequest(output, true), {}, core::silentProgress());
    for (const std::string name : {"bug2/truth.tum", "bug2/trajectory.tum", "bug2/states.csv",
                                   "bug2/path.png", "paths.png", "scores.csv"})
      bytes[i] += files::readTextFile(output + "/" + name);
  }
  EXPECT_EQ(bytes[0], bytes[1]);
}

TEST(ReachGoal, RefusesWhatCannotBeMeant) {
  const testing::TempFolder folder;
  const auto errorOf = [&](auto change) -> std::string {
    auto request = roomRequest(folder / "out", true);
    change(request);
    try {
      reachGoal(request, {}, core::silentProgress());
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_EQ(errorOf([](auto& r) {
              r.p_world_goal = {50, 1};
            }),
            "plan 'room': goal (50.000 m, 1.000 m) is outside the plan, expected a place on the floor");
  EXPECT_EQ(errorOf([](auto& r) {
              r.p_world_goal = {0.01, 1};
            }),
            "plan 'room': goal (0.010 m, 1.000 m) is in a wall, expected a place on the floor");
  EXPECT_THAT(errorOf([](auto& r) { r.T_world_start = {0.2, 1, 0}; }), HasSubstr("too near to a wall"));
  EXPECT_THAT(errorOf([](auto& r) { r.T_world_start = {-5, 1, 0}; }), HasSubstr("outside the plan"));
  EXPECT_THAT(errorOf([](auto& r) { r.methods = {"bug2", "bug2"}; }), HasSubstr("named twice"));
  EXPECT_THAT(errorOf([](auto& r) { r.methods = {"tangens"}; }), HasSubstr("did you mean 'tangent'?"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ParsePlace, TakesNumbersOnly) {
  EXPECT_EQ(parsePlace(" 1.5  -2 ", "--goal").y, -2);
  EXPECT_EQ(parsePlace("1.5,-2", "--goal").y, -2);
  EXPECT_NEAR(parsePose("1 2 90", "--start").phi, core::kPi / 2, 1e-12);
  for (const std::string text : {"", "1", "1 2 3", "1 x", "1 nan", "1,2,3", "1,,2"})
    EXPECT_THROW(parsePlace(text, "--goal"), core::InputError) << text;
}

TEST(ReachGoal, DrivesWithMrptsNavigationWhereItIsThere) {
  auto request = roomRequest("", false);
  if (!mrptnav::reactiveNavigationAvailable() || !fs::exists(request.config.mrpt_reactive.config))
    GTEST_SKIP() << "built without MRPT's module nav, or without mrpt-common's configuration";
  request.config.mrpt_reactive.look_ahead_m = 1.5;  // MRPT's preparations cost its square
  const auto run = driveToGoal(request, "mrpt_reactive", core::silentProgress());
  EXPECT_EQ(run.status, goals::GoalStatus::kReached) << run.reason;
  EXPECT_EQ(run.collisions, 0U);
  ASSERT_FALSE(run.changes.empty());
  EXPECT_EQ(run.changes.front().to, "reactive");
}

}  // namespace
}  // namespace slam::reach
