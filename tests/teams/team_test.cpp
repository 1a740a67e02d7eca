#include "libslam/teams/team.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/teams/team_radio.h"
#include "libslam/testing/temp_folder.h"
#include "tests/explore/two_rooms.h"

namespace slam::teams {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Two rooms of 8 x 7 m on either side of a hall with a door to each.
world::Plan hallWithRooms() {
  return explore::drawnPlan("hall_with_rooms", 400, 140,
                            {{160, 0, 163, 110},
                             {160, 130, 163, 140},
                             {240, 0, 243, 110},
                             {240, 130, 243, 140},
                             {60, 40, 63, 138},
                             {340, 40, 343, 138}});
}

TeamRequest teamRequest(const testing::TempFolder& folder, const world::Plan& plan, int robots,
                        const std::string& strategy, const std::string& slam = explore::kTruthReference) {
  TeamRequest request;
  request.plan_path = explore::saved(folder, plan);
  request.config = explore::quickConfig(strategy, 400, {"simulation.start=10,3,90"});
  request.slam = slam;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = folder / "out";
  request.robots = robots;
  return request;
}

TeamReport run(const TeamRequest& request) {
  return exploreTeam(request, {}, core::silentProgress());
}

std::map<std::string, std::string> hashesIn(const std::string& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (entry.is_regular_file() && name != "cost.csv" && name.find("manifest.json") == std::string::npos)
      hashes[fs::relative(entry.path(), folder).string()] = resources::fileSha256(entry.path().string());
  }
  return hashes;
}

TEST(Team, TwoExploreFasterThanOneAndDoNotCollide) {
  for (const std::string strategy : {"nearest_frontier", "information_gain", "next_best_view"}) {
    const testing::TempFolder folder;
    auto one = explore::request(folder, hallWithRooms(),
                                {explore::quickConfig(strategy, 400, {"simulation.start=10,3,90"})},
                                explore::kTruthReference);
    one.output = folder / "one";
    const double alone_s = explore::run(one).runs.front().figures.t99_s;
    const auto report = run(teamRequest(folder, hallWithRooms(), 2, strategy));
    EXPECT_EQ(report.team.end, explore::ExplorationEnd::kFinished) << strategy;
    EXPECT_GT(report.team.figures.coverage, 0.99) << strategy;
    // Two mirrored halves: each robot has one. A third of the time is for what both have to see and wait for.
    EXPECT_LT(report.team.figures.t99_s, 0.8 * alone_s) << strategy;
    EXPECT_EQ(report.team.robot_collisions, 0) << strategy;
    EXPECT_EQ(report.team.wall_collisions, 0) << strategy;
    EXPECT_LT(report.team.overlap, 0.7) << strategy;
    EXPECT_GT(report.team.evaluation.map.occupied_f1, 0.9) << strategy;
  }
}

TEST(Team, LeavesAFolderPerRobotAndOneMap) {
  const testing::TempFolder folder;
  auto both = teamRequest(folder, hallWithRooms(), 2, "nearest_frontier", "icp");
  both.config = explore::quickConfig("nearest_frontier", 20, {"simulation.start=10,3,90"});
  const auto report = run(both);
  for (const char* file :
       {"robot1/run.rawlog", "robot2/run.rawlog.GT.txt", "robot2/run.gt.tum", "robot1/map.png",
        "robot2/map.yaml", "robot2/exploration.csv", "robot1/decisions.csv", "robot1/path.png", "map.png",
        "map.yaml", "map.gridmap.gz", "exploration.json", "team.csv", "scores.txt", "scores.json", "runs.csv",
        "path.png", "coverage.png", "manifest.json"})
    EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
  const auto json = nlohmann::json::parse(files::readTextFile(folder / "out/exploration.json"));
  EXPECT_EQ(json["robots"], 2);
  EXPECT_TRUE(json["radio_range_m"].is_null());
  EXPECT_NEAR(json["path_sum_m"].get<double>(),
              report.robots[0].figures.path_m + report.robots[1].figures.path_m, 1e-3);
  // Beside each other, 0.3 m between the discs of 0.283 m.
  const auto starts = teamStarts(hallWithRooms(), both);
  EXPECT_NEAR(core::distance(starts[0], starts[1]), 0.3 + 2 * 0.2828, 1e-3);
  EXPECT_EQ(starts[0].phi, starts[1].phi);
}

TEST(Team, TheBytesAreThoseOfTheSeedWhateverTheThreads) {
  const testing::TempFolder folder;
  auto team = teamRequest(folder, explore::twoRooms(), 2, "next_best_view", "graph");
  team.config = explore::quickConfig("next_best_view", 15, {"simulation.start=1.5,1.5,0"});
  run(team);
  const auto first = hashesIn(folder / "out");
  team.output = folder / "again";
  team.threads = 2;
  run(team);
  EXPECT_EQ(first, hashesIn(folder / "again"));
  team.output = folder / "other";
  team.seed = 2;
  run(team);
  EXPECT_NE(first.at("robot2/run.gt.tum"), hashesIn(folder / "other").at("robot2/run.gt.tum"));
}

TEST(Team, OutOfRadioRangeNothingIsShared) {
  const testing::TempFolder folder;
  auto deaf = teamRequest(folder, hallWithRooms(), 2, "nearest_frontier");
  deaf.radio_range_m = 0;
  const auto apart = run(deaf);
  deaf.radio_range_m = std::numeric_limits<double>::infinity();
  deaf.output = folder / "together";
  const auto together = run(deaf);
  EXPECT_EQ(apart.team.robot_collisions, 0);
  EXPECT_EQ(apart.team.figures.coverage > 0.99, true);
  // Each explores all of it for itself: what one has seen, the other has.
  EXPECT_GT(apart.team.overlap, 0.95);
  EXPECT_GT(apart.team.path_sum_m, 1.3 * together.team.path_sum_m);
}

TEST(Team, RefusesWhatCannotBe) {
  const testing::TempFolder folder;
  const auto refusal = [&](const auto& change) -> std::string {
    auto team = teamRequest(folder, explore::twoRooms(), 2, "nearest_frontier");
    team.config = explore::quickConfig("nearest_frontier", 5, {"simulation.start=1.5,1.5,0"});
    change(team);
    try {
      run(team);
    } catch (const core::InputError& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(refusal([](TeamRequest& t) { t.robots = 0; }), HasSubstr("--robots: found 0, expected 1 to 4"));
  EXPECT_THAT(refusal([](TeamRequest& t) { t.robots = 5; }), HasSubstr("found 5, expected 1 to 4"));
  EXPECT_THAT(refusal([](TeamRequest& t) { t.radio_range_m = -1; }), HasSubstr("--radio-range: found -1"));
  EXPECT_THAT(refusal([](TeamRequest& t) { t.config.record.living.people = 3; }), HasSubstr("people"));
  EXPECT_THAT(refusal([](TeamRequest& t) { t.config.exploration.return_to_start = true; }),
              HasSubstr("--return"));
  EXPECT_THAT(refusal([](TeamRequest& t) { t.T_world_starts = {{1, 1, 0}}; }), HasSubstr("found 1 places"));
  EXPECT_THAT(refusal([](TeamRequest& t) {
                t.T_world_starts = {{1, 1, 0}, {1.3, 1, 0}};
              }),
              HasSubstr("0.300 m apart"));
  EXPECT_THAT(refusal([](TeamRequest& t) {
                t.T_world_starts = {{1, 1, 0}, {0, 0, 0}};
              }),
              HasSubstr("start of robot 2"));
}

/// A room of 1 x 1 m beside which there is nothing.
TEST(Team, SaysHowManyRobotsFit) {
  const testing::TempFolder folder;
  world::Plan closet = explore::twoRooms();
  for (int row = 0; row < closet.rows; ++row)
    for (int column = 0; column < closet.columns; ++column)
      if (row < 30 || row >= 50 || column < 20 || column >= 60)
        closet.cells[static_cast<size_t>(row) * closet.columns + column] = world::Cell::kOccupied;
  auto team = teamRequest(folder, closet, 4, "nearest_frontier");
  team.config = explore::quickConfig("nearest_frontier", 5, {"simulation.start=1.5,2,0"});
  try {
    run(team);
    FAIL() << "expected InputError";
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--robots 4: found room for 2 round the start"));
  }
  EXPECT_FALSE(fs::exists(folder / "out"));
}

TEST(TeamRadio, PassesOnWhatItHeardAndForgetsGoals) {
  TeamRadio radio({{0, 0, 0}, {2, 0, 0}, {4, 0, 0}}, 3.0);
  const auto map = std::make_shared<const gridmap::OccupancyRaster>();
  const auto say = [&](std::size_t robot, double time_s) {
    radio.tell(robot, {time_s, {1, 0, 0}, core::Point2{2, 0}, nullptr});
  };
  radio.listen({{0, 0}, {2, 0}, {4, 0}});  // the first hears the last by way of the second
  EXPECT_TRUE(radio.hears(0, 2));
  say(2, 10);
  auto team = radio.teamOf(0, 10);
  ASSERT_EQ(team.size(), 1U);
  EXPECT_TRUE(team[0].is_heard);
  EXPECT_DOUBLE_EQ(team[0].p_map.x, 5);  // 4 m beside it at the start, 1 m on
  ASSERT_TRUE(team[0].goal);
  EXPECT_DOUBLE_EQ(team[0].goal->x, 6);
  radio.listen({{0, 0}, {9, 0}, {20, 0}});
  team = radio.teamOf(0, 10 + kRemembers_s);
  ASSERT_EQ(team.size(), 1U);
  EXPECT_FALSE(team[0].is_heard);
  EXPECT_TRUE(radio.teamOf(0, 11 + kRemembers_s).empty());
}

}  // namespace
}  // namespace slam::teams
