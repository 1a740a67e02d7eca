#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>

#include "libslam/core/error.h"
#include "libslam/explore/explore.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/reach/reach_goal.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/truth/truth_files.h"

namespace slam::explore {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

files::IniFile settings(const std::vector<std::string>& more) {
  files::IniFile ini;
  for (const char* setting : {"simulation.duration_s=20", "lidar.beams=91", "strategy.name=random_heading"})
    ini.setFromArgument(setting, "test");
  for (const auto& setting : more) ini.setFromArgument(setting, "test");
  return ini;
}

world::Plan flat() {
  return world::loadPlan(resources::resolvePlan("flat"));
}

std::vector<std::vector<std::string>> readCsv(const std::string& path) {
  const std::string text = files::readTextFile(path);
  files::CsvReader reader(text, path);
  std::vector<std::vector<std::string>> rows;
  for (std::vector<std::string> fields; reader.next(fields);) rows.push_back(fields);
  return rows;
}

TEST(RecordLivingWorld, SaysWhereEveryPersonWasAtEveryScan) {
  const testing::TempFolder folder;
  const auto config = record::readRecordConfig(settings({"living.people=3"}));
  const auto recording = record::record(flat(), config, 1, folder / "run.rawlog", {}, core::silentProgress());
  EXPECT_THAT(recording.files, ::testing::Contains(folder / "run.movers.csv"));
  const auto rows = readCsv(folder / "run.movers.csv");
  const auto truth = logs::readTum(folder / "run.gt.tum");
  ASSERT_EQ(rows.size(), 1 + 3 * truth.size());
  EXPECT_EQ(rows[0],
            (std::vector<std::string>{"time_s", "kind", "id", "x_m", "y_m", "heading_rad", "state"}));
  for (size_t i = 1; i < rows.size(); ++i) {
    ASSERT_EQ(rows[i].size(), 7U);
    EXPECT_EQ(rows[i][0], files::formatNumber(truth[(i - 1) / 3].time_s));
    EXPECT_EQ(rows[i][1], "person");
    EXPECT_EQ(rows[i][2], std::to_string((i - 1) % 3));
    // Rounded to a millimetre, the disc is as much smaller.
    EXPECT_FALSE(world::discCollides(flat(), {std::stod(rows[i][3]), std::stod(rows[i][4])}, 0.249));
  }
  const auto manifest = resources::readManifest(folder / "run.manifest.json");
  EXPECT_EQ(manifest.files.count("run.movers.csv"), 1U);
  EXPECT_EQ(manifest.config.at("living.people"), "3");
  EXPECT_EQ(manifest.files.count("run.plan.yaml"), 0U);
}

TEST(RecordLivingWorld, GivesTheSameBytesForTheSameSeed) {
  const testing::TempFolder folder;
  auto config = record::readRecordConfig(settings({"living.people=4", "living.visit=2"}));
  for (const std::string name : {"a", "b"})
    record::record(flat(), config, 3, folder / (name + ".rawlog"), {}, core::silentProgress());
  for (const std::string suffix : {".rawlog", ".gt.tum", ".movers.csv", ".plan.png"})
    EXPECT_EQ(resources::fileSha256(folder / ("a" + suffix)), resources::fileSha256(folder / ("b" + suffix)))
        << suffix;
}

TEST(RecordLivingWorld, WritesNothingOfMoversWhereNothingMoves) {
  const testing::TempFolder folder;
  record::record(flat(), record::readRecordConfig(settings({})), 1, folder / "run.rawlog", {},
                 core::silentProgress());
  EXPECT_FALSE(fs::exists(folder / "run.movers.csv"));
  EXPECT_FALSE(fs::exists(folder / "run.plan.yaml"));
}

TEST(RecordLivingWorld, SaysWhenDoorsMove) {
  const testing::TempFolder folder;
  world::Plan plan = flat();
  plan.doors = {{130, 60, 133, 63}};  // wherever there is floor
  for (int row = 60; row < 63; ++row)
    for (int column = 130; column < 133; ++column)
      plan.cells[static_cast<size_t>(row) * plan.columns + column] = world::Cell::kFree;
  const auto config = record::readRecordConfig(
      settings({"living.doors_share=1", "living.door_open_s=2", "living.door_closed_s=2"}));
  record::record(plan, config, 1, folder / "run.rawlog", {}, core::silentProgress());
  const auto rows = readCsv(folder / "run.movers.csv");
  ASSERT_GT(rows.size(), 4U);
  EXPECT_LT(rows.size(), 30U);  // only what changes
  EXPECT_EQ(rows[1][1], "door");
  EXPECT_EQ(rows[1][6], "open");
  EXPECT_TRUE(std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row[6] == "closed"; }));
}

TEST(RecordLivingWorld, ALaterVisitIsScoredOnThePlanThatWasThere) {
  const testing::TempFolder folder;
  score::CompareRequest request;
  request.plan_path = resources::resolvePlan("flat");
  request.record = record::readRecordConfig(settings({"living.visit=2", "living.furniture_share=1"}));
  request.methods = {"naive_wheel"};
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = folder / "out";
  const auto comparison = score::compare(request, {}, core::silentProgress());
  const auto found = world::loadPlan(folder / "out/log/run.plan.yaml");
  EXPECT_EQ(found.cells, record::planOfVisit(flat(), request.record.living, 1).cells);
  EXPECT_NE(found.cells, flat().cells);
  EXPECT_EQ(truth::findPlan(comparison.log_path), folder / "out/log/run.plan.yaml");
  score::Truth given;
  given = score::loadTruth(folder / "out/log/run.gt.tum", folder / "out/log/run.plan.yaml",
                           results::loadRun(folder / "out/naive_wheel"));
  EXPECT_EQ(comparison.evaluations[0].map.occupied_f1,
            score::evaluate(results::loadRun(folder / "out/naive_wheel"), given).map.occupied_f1);
}

TEST(RecordLivingWorld, EveryVisitIsAnother) {
  movers::LivingOptions living;
  living.furniture_share = 1;
  const auto plan = flat();
  EXPECT_EQ(record::planOfVisit(plan, living, 1).cells, plan.cells);
  living.visit = 2;
  const auto second = record::planOfVisit(plan, living, 1);
  living.visit = 3;
  const auto third = record::planOfVisit(plan, living, 1);
  EXPECT_NE(second.cells, plan.cells);
  EXPECT_NE(third.cells, second.cells);
  EXPECT_NE(third.cells, plan.cells);
}

TEST(RecordLivingWorld, RefusesMorePeopleThanThereIsRoomForAndLeavesNothing) {
  const testing::TempFolder folder;
  const auto config = record::readRecordConfig(settings({"living.people=900"}));
  EXPECT_THAT(testing::errorOf([&] {
                record::record(flat(), config, 1, folder / "run.rawlog", {}, core::silentProgress());
              }),
              HasSubstr("plan 'flat': section [living], key 'people': found 900, expected at most "));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ExploreLivingWorld, RunsToItsEnd) {
  const testing::TempFolder folder;
  ExploreRequest request;
  request.plan_path = resources::resolvePlan("flat");
  request.strategies = {readExploreConfig(settings({"living.people=3", "living.visit=2"}))};
  request.slam = kTruthReference;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = folder / "out";
  const auto report = explore(request, {}, core::silentProgress());
  EXPECT_EQ(report.failed, 0);
  EXPECT_GT(report.runs[0].figures.coverage, 0.1);
  EXPECT_TRUE(fs::exists(folder / "out/run.movers.csv"));
  EXPECT_TRUE(fs::exists(folder / "out/run.plan.yaml"));
}

TEST(NavigateInLivingWorld, RunsToItsEnd) {
  reach::ReachGoalRequest request;
  request.plan = world::loadPlan(resources::resolvePlan("pillar_hall"));
  files::IniFile ini;
  for (const char* setting : {"lidar.beams=181", "living.people=6", "navigate.time_limit_s=60"})
    ini.setFromArgument(setting, "test");
  request.config = reach::readReachGoalConfig(ini);
  request.T_world_start = *world::findStartPose(request.plan, 0.6);
  request.p_world_goal = {request.T_world_start.x + 3, request.T_world_start.y + 2};
  const auto run = reach::driveToGoal(request, "tangent", core::silentProgress());
  EXPECT_NE(run.status, goals::GoalStatus::kMoving);
}

}  // namespace
}  // namespace slam::explore
