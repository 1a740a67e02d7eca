#include "libslam/explore/explore.h"
#include "libslam/explore/exploration_referee.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/results/journal_file.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/temp_folder.h"
#include "tests/explore/two_rooms.h"

namespace slam::explore {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool holds_times =
        name == "cost.csv" || name == "cost.json" || name.find("manifest.json") != std::string::npos;
    if (entry.is_regular_file() && !holds_times)
      hashes[fs::relative(entry.path(), folder).string()] = resources::fileSha256(entry.path().string());
  }
  return hashes;
}

/// Stands at the start and is done.
class Idle : public strategies::Strategy {
 public:
  choices::Decision decide(const lidar::Scan& /*scan*/, const core::Pose2& /*T_map_robot*/) override {
    choices::Decision decision;
    decision.finished = true;
    decision.reason = "seen enough";
    return decision;
  }
};

TEST(Explore, TakesAStrategyFromOutside) {
  const testing::TempFolder folder;
  auto mine = quickConfig("nearest_frontier", 20);
  mine.own = OwnStrategy{"idle", [](const strategies::StrategyOptions&, core::RandomStream) {
                           return std::make_unique<Idle>();
                         }};
  const auto result =
      run(request(folder, twoRooms(), {mine, quickConfig("nearest_frontier", 20)}, kTruthReference));
  ASSERT_EQ(result.runs.size(), 2U);
  EXPECT_EQ(result.runs[0].strategy, "idle");
  EXPECT_EQ(result.runs[0].end_detail, "seen enough");
  EXPECT_EQ(result.runs[1].strategy, "nearest_frontier");
  EXPECT_GT(result.runs[1].figures.coverage, result.runs[0].figures.coverage);
  EXPECT_TRUE(fs::exists(folder / "out/idle/run.rawlog"));
  const testing::TempFolder twice;
  EXPECT_THROW(run(request(twice, twoRooms(), {mine, mine}, kTruthReference)), core::InputError);
}

TEST(Explore, FindsEverythingInASmallFlatAndComesBack) {
  for (const std::string slam : {"truth", "icp"}) {
    const testing::TempFolder folder;
    const auto result =
        run(request(folder, twoRooms(),
                    {quickConfig("nearest_frontier", 300, {"exploration.return_to_start=true"})}, slam));
    ASSERT_EQ(result.runs.size(), 1U);
    const auto& e = result.runs.front();
    EXPECT_EQ(e.end, ExplorationEnd::kFinished) << slam << ": " << endName(e.end);
    EXPECT_GT(e.figures.coverage, 0.99) << slam;
    EXPECT_LE(e.figures.coverage, 1.0) << slam;
    EXPECT_EQ(e.collisions, 0) << slam;
    // Half a metre: it stops 0.3 m from the map's origin, and ICP in two small rooms errs by centimetres.
    EXPECT_LT(e.return_distance_m, 0.5) << slam;
    EXPECT_LE(e.figures.t90_s, e.figures.t99_s);
    // Nearly all of the free floor: only corners behind the door's posts may be out of sight.
    EXPECT_GT(e.explorable_share, 0.98);
    for (const char* file :
         {"run.rawlog",     "run.rawlog.GT.txt", "run.gt.tum",     "run.operations.txt", "run.manifest.json",
          "map.png",        "map.yaml",          "map.gridmap.gz", "map.simplemap",      "map.3Dscene",
          "trajectory.tum", "exploration.csv",   "decisions.csv",  "path.png",           "scores.txt",
          "scores.md",      "scores.tex",        "scores.csv",     "scores.json",        "runs.csv",
          "cost.csv",       "coverage.png",      "manifest.json"})
      EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
    if (slam == "truth") {
      // Perfect wheels: what the reference believes is the truth, seen from the start.
      EXPECT_LT(e.evaluation.trajectory.position_m.max, 1e-6);
      EXPECT_THAT(files::readTextFile(folder / "out/scores.txt"), HasSubstr("true pose (reference)"));
    } else {
      EXPECT_GT(e.evaluation.trajectory.position_m.max, 1e-4);
    }
  }
}

TEST(Explore, ScoresAgainstSomebodyWhoKnowsThePlan) {
  const testing::TempFolder folder;
  auto wanted = request(folder, twoRooms(), {quickConfig("nearest_frontier", 300)}, "truth");
  wanted.oracle = wanted.tables_only = true;
  const auto report = run(wanted);
  const auto& e = report.runs.front();
  ASSERT_TRUE(std::isfinite(e.figures.path99_m));
  EXPECT_DOUBLE_EQ(e.ratio99, e.figures.path99_m / e.oracle99_m);
  EXPECT_DOUBLE_EQ(e.ratio90, e.figures.path90_m / e.oracle90_m);
  // Nobody is below the bound, whatever he knows.
  EXPECT_LE(e.below99_m, e.oracle99_m);
  EXPECT_LE(e.below99_m, e.figures.path99_m);
  EXPECT_LE(e.below90_m, e.figures.path90_m);
  for (const char* file : {"oracle.csv", "oracle_path.csv", "oracle.png"})
    EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
  const auto text = files::readTextFile(folder / "out/scores.txt");
  EXPECT_THAT(text, HasSubstr("  ratio  ratio  "));
  EXPECT_THAT(text, HasSubstr("With the plan in hand"));
  EXPECT_THAT(files::readTextFile(folder / "out/runs.csv"), HasSubstr("below99_m"));
}

TEST(Explore, HasNoRatiosUnlessAsked) {
  const testing::TempFolder folder;
  auto wanted = request(folder, twoRooms(), {quickConfig("nearest_frontier", 2)}, "truth");
  wanted.tables_only = true;
  EXPECT_TRUE(std::isnan(run(wanted).runs.front().ratio99));
  EXPECT_FALSE(fs::exists(folder / "out/oracle.csv"));
  EXPECT_EQ(files::readTextFile(folder / "out/scores.txt").find("  ratio  "), std::string::npos);
}

TEST(Explore, RefusesAnOracleForACameraBeforeItDrives) {
  const testing::TempFolder folder;
  files::IniFile ini;
  ini.setFromArgument("sensor.kind=camera", "test");
  ini.set("strategy", "name", "nearest_frontier", "test");
  auto wanted = request(folder, twoRooms(), {readExploreConfig(ini)}, "truth");
  wanted.oracle = true;
  try {
    run(wanted);
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_STREQ(error.what(),
                 "section [sensor], key 'kind': found 'camera', expected 'lidar' with --oracle");
  }
}

/// Runs with a lidar of three quarters of a circle in a world that comes with the program.
std::vector<Exploration> inWorld(const std::string& world, const std::vector<std::string>& strategies,
                                 std::uint64_t seed) {
  const testing::TempFolder folder;
  std::vector<ExploreConfig> configs;
  configs.reserve(strategies.size());
  for (const auto& strategy : strategies)
    configs.push_back(
        quickConfig(strategy, 1000, {"lidar.beams=181", "lidar.fov_deg=270", "lidar.max_range_m=30"}));
  auto wanted = request(folder, twoRooms(), configs, "truth");
  wanted.plan_path = resources::resolvePlan(world);
  wanted.seed = seed;
  wanted.tables_only = true;
  return run(wanted).runs;
}

// Between chairs the map of noisy readings closed in on the robot, which then saw no way out and said that it
// had finished, with half of the flat or less explored.
TEST(Explore, DoesNotFinishBecauseItStandsInATightPlace) {
  for (const std::uint64_t seed : {2, 3}) {
    const auto e = inWorld("flat", {"nearest_frontier"}, seed).front();
    EXPECT_EQ(e.end, ExplorationEnd::kFinished) << endName(e.end);
    EXPECT_GT(e.figures.coverage, 0.99) << e.end_detail;
    EXPECT_EQ(e.collisions, 0);
  }
}

// A wall on the line between two rows of cells never settles in the map; its gaps promised a lot of unknown
// behind them for ever, and the robot drove up and down the corridor until the referee ended it.
TEST(Explore, NoticesThatNothingIsLeft) {
  for (const auto& e :
       inWorld("corridor", {"nearest_frontier", "information_gain", "next_best_view", "tour"}, 3)) {
    EXPECT_EQ(e.end, ExplorationEnd::kFinished) << e.strategy << ": " << endName(e.end);
    EXPECT_THAT(e.end_detail, ::testing::StartsWith("explored: ")) << e.strategy;
    EXPECT_GT(e.figures.coverage, 0.99) << e.strategy;
  }
}

TEST(Explore, GivesTheSameBytesWithOneAndTwoThreads) {
  const testing::TempFolder folder;
  auto wanted =
      request(folder, twoRooms(), {quickConfig("quadrant", 20), quickConfig("next_best_view", 20)}, "icp");
  wanted.seeds = 2;
  wanted.output = folder / "one";
  run(wanted);
  wanted.output = folder / "two";
  wanted.threads = 2;
  run(wanted);
  const auto one = contents(folder / "one");
  EXPECT_GT(one.size(), 50U);
  EXPECT_EQ(one, contents(folder / "two"));
  EXPECT_NE(one.at("quadrant/seed_1/run.rawlog"), one.at("quadrant/seed_2/run.rawlog"));
}

TEST(Explore, TablesAloneAreTheSameTables) {
  const testing::TempFolder folder;
  auto wanted = request(folder, twoRooms(), {quickConfig("quadrant", 15)}, "naive_wheel");
  run(wanted);
  wanted.output = folder / "tables";
  wanted.tables_only = true;
  run(wanted);
  EXPECT_FALSE(fs::exists(folder / "tables/run.rawlog"));
  for (const char* file : {"scores.csv", "runs.csv", "scores.txt", "coverage.png"})
    EXPECT_EQ(resources::fileSha256(folder / ("out/" + std::string(file))),
              resources::fileSha256(folder / ("tables/" + std::string(file))))
        << file;
}

TEST(Explore, AFolderOfOneRunIsScoredAgainByEvaluate) {
  const testing::TempFolder folder;
  const auto result = run(request(folder, twoRooms(), {quickConfig("quadrant", 20)}, "icp"));
  const auto again = results::loadRun(folder / "out");
  const auto truth = score::loadTruth(folder / "out/run.gt.tum", folder / "two_rooms.yaml", again);
  const auto evaluation = score::evaluate(again, truth);
  // TUM files keep nine decimals of a metre.
  EXPECT_NEAR(evaluation.trajectory.position_m.rmse, result.runs[0].evaluation.trajectory.position_m.rmse,
              1e-6);
  // A score leaves out poses close to each other, so it knows of a few seen cells less.
  EXPECT_NEAR(evaluation.map.occupied_f1, result.runs[0].evaluation.map.occupied_f1, 0.02);
}

TEST(Explore, ARobotThatSeesNothingIsStuckAndSaysSo) {
  const testing::TempFolder folder;
  const std::vector<std::string> blind = {"lidar.drop_out=1", "exploration.stuck_s=20"};
  std::vector<ExploreConfig> configs;
  for (const auto& strategy : strategies::strategyNames())
    configs.push_back(quickConfig(strategy, 200, blind));
  auto wanted = request(folder, twoRooms(), configs, "icp");
  wanted.tables_only = true;
  const auto result = run(wanted);
  ASSERT_EQ(result.runs.size(), configs.size());
  for (const auto& e : result.runs) {
    EXPECT_THAT(endName(e.end), ::testing::AnyOf("stuck", "finished")) << e.strategy;
    EXPECT_LT(e.figures.time_s, 60) << e.strategy;
    EXPECT_EQ(e.collisions, 0) << e.strategy;
  }
  EXPECT_THAT(result.scores.notes, ::testing::Contains(HasSubstr("No scan had a single return")));
}

// A lidar that reaches no farther than the robot's own body: every beam is sure that nothing is there.
TEST(Explore, ALidarTooShortToSeeAnythingEndsTheRunToo) {
  const testing::TempFolder folder;
  std::vector<ExploreConfig> configs;
  for (const auto& strategy : strategies::strategyNames())
    configs.push_back(quickConfig(strategy, 60, {"lidar.max_range_m=0.25", "exploration.stuck_s=20"}));
  auto wanted = request(folder, twoRooms(), configs, "truth");
  wanted.tables_only = true;
  for (const auto& e : run(wanted).runs) EXPECT_LE(e.figures.time_s, 60) << e.strategy;
}

TEST(Explore, TheRefereeEndsARunThatShowsNothingNew) {
  const testing::TempFolder folder;
  // From the middle of the flat a short while shows everything; this strategy never knows that.
  const auto result = run(request(
      folder, twoRooms(), {quickConfig("random_heading", 2000, {"exploration.give_up_s=30"})}, "truth"));
  EXPECT_EQ(result.runs[0].end, ExplorationEnd::kGaveUp);
  EXPECT_LT(result.runs[0].figures.time_s, 600);
}

TEST(Explore, TheRefereeLetsAStrategyWait) {
  ExplorationOptions options;
  options.stuck_s = 60;
  const auto endOf = [&](double waited_s) {
    Referee referee(options);
    for (double time_s = 0; time_s < 500; time_s += 0.2)
      if (referee.judge(time_s, 1, {}, time_s > 10 && time_s <= 10 + waited_s)) return time_s;
    return 500.0;
  };
  EXPECT_NEAR(endOf(0), 60, 0.5);
  EXPECT_NEAR(endOf(100), 160, 0.5);
}

TEST(Explore, AStartThatIsCutOffAndAnOpenPlanAreSaid) {
  auto plan = twoRooms();
  for (int row = 30; row < 50; ++row)
    for (int column = 60; column < 63; ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = world::Cell::kOccupied;
  for (int row = 10; row < 70; ++row)  // the right room's outer wall is gone
    for (int column = 118; column < 120; ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = world::Cell::kFree;
  const testing::TempFolder folder;
  auto wanted = request(folder, plan,
                        {quickConfig("nearest_frontier", 120, {"simulation.start=1.5 2 0"}),
                         quickConfig("quadrant", 30, {"simulation.start=1.5 2 0"})},
                        "truth");
  const auto left = run(wanted);
  EXPECT_THAT(left.scores.notes, ::testing::Contains(HasSubstr("From the start only 5")));
  EXPECT_THAT(left.scores.notes, ::testing::Not(::testing::Contains(HasSubstr("open"))));
  EXPECT_GT(left.runs[0].figures.coverage, 0.99);
  wanted.strategies = {quickConfig("nearest_frontier", 120, {"simulation.start=4.5 2 0"}),
                       quickConfig("longest_ray", 60, {"simulation.start=4.5 2 0"})};
  wanted.overwrite = true;
  const auto right = run(wanted);
  EXPECT_THAT(right.scores.notes, ::testing::Contains(HasSubstr("The plan is open")));
  EXPECT_GT(right.runs[0].figures.coverage, 0.9);
}

TEST(Explore, ACarriedRobotIsKnownToTheTruthAlone) {
  const testing::TempFolder folder;
  const auto result = explore(
      request(folder, twoRooms(),
              {quickConfig("longest_ray", 8, {"simulation.start=1.5 2 0", "events.carry=4:4.5,2,180"})},
              "naive_wheel"),
      {}, core::silentProgress());
  EXPECT_THAT(table::toText(result.scores), HasSubstr("longest_ray: kidnapped at 4.0 s from"));
  const auto truth = logs::readTum(folder / "out/run.gt.tum");
  const auto estimate = logs::readTum(folder / "out/trajectory.tum");
  double longest_true_m = 0, longest_believed_m = 0;
  for (size_t i = 1; i < truth.size(); ++i) {
    longest_true_m = std::max(longest_true_m, core::distance(truth[i - 1].pose, truth[i].pose));
    longest_believed_m = std::max(longest_believed_m, core::distance(estimate[i - 1].pose, estimate[i].pose));
  }
  EXPECT_GT(longest_true_m, 0.5);
  EXPECT_LT(longest_believed_m, 0.2);
  EXPECT_LT(result.runs.at(0).figures.path_m, core::pathLength(truth) - 0.5);
  EXPECT_TRUE(fs::exists(folder / "out/run.carries.csv"));
}

}  // namespace
}  // namespace slam::explore
