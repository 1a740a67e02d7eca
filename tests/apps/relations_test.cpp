#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/file_hash.h"
#include "libslam/testing/temp_folder.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST(EvalByRelations, ScoresATrajectoryByItself) {
  const testing::TempFolder folder;
  logs::writeTum({{1, {0, 0, 0}}, {2, {1, 0, 0}}, {3, {2, 0, 0}}}, folder / "path.tum");
  logs::writeRelations({{1, 2, {1, 0, 0}}, {1, 3, {1.9, 0, 0}}, {3, 9, {0, 0, 0}}}, folder / "a.relations");
  const auto text = rasterslam("eval " + (folder / "path.tum") + " --relations " + (folder / "a.relations"));
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("Error against 3 relations"));
  EXPECT_THAT(text.out, HasSubstr("0.0500"));
  EXPECT_THAT(text.out, HasSubstr("interpolated"));
  EXPECT_THAT(text.out,
              HasSubstr("path.tum: 1 relations name a stamp outside the path's time span: not scored."));
  EXPECT_THAT(text.out, HasSubstr("1.90 0.00 0.0"));  // the worst, as the relation says
  const auto json =
      rasterslam("eval " + (folder / "path.tum") + " --json --relations " + (folder / "a.relations"));
  const auto row = nlohmann::json::parse(json.out)["relations"]["rows"][0];
  EXPECT_NEAR(row["translation_mean_m"].get<double>(), 0.05, 1e-9);
  EXPECT_NEAR(row["translation_max_m"].get<double>(), 0.1, 1e-9);
  EXPECT_EQ(row["scored"], 2);
  EXPECT_EQ(row["unmatched"], 1);
}

TEST(EvalByRelations, RefusesWhatDoesNotBelongTogether) {
  const testing::TempFolder folder;
  logs::writeTum({{1, {0, 0, 0}}, {2, {1, 0, 0}}}, folder / "path.tum");
  logs::writeRelations({{100, 200, {1, 0, 0}}}, folder / "a.relations");
  const std::string command = "eval " + (folder / "path.tum") + " --relations " + (folder / "a.relations");
  const auto other_log = rasterslam(command);
  EXPECT_EQ(other_log.exit_code, 3);
  EXPECT_THAT(other_log.err, HasSubstr("no stamp in common"));
  const auto two_truths = rasterslam(command + " --truth " + (folder / "path.tum"));
  EXPECT_EQ(two_truths.exit_code, 3);
  EXPECT_THAT(two_truths.err, HasSubstr("--relations"));
}

TEST(Relations, OfATruePathScoreItWithoutError) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat -o run.rawlog --duration 60 --seed 2 -q", folder.path()).exit_code, 0);
  const auto made = rasterslam("relations run.gt.tum -o run.relations --step 0.5 --near 2 --apart 20 --json",
                               folder.path());
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const auto facts = nlohmann::json::parse(made.out);
  EXPECT_EQ(facts["relations"], logs::readRelations(folder / "run.relations").size());
  EXPECT_GT(facts["places_seen_again"], 0);
  EXPECT_LT(facts["places_seen_again"], facts["relations"]);
  const auto scored = rasterslam("eval run.gt.tum --relations run.relations --json", folder.path());
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const auto row = nlohmann::json::parse(scored.out)["relations"]["rows"][0];
  EXPECT_LT(row["translation_max_m"].get<double>(), 5e-6);  // six decimals of a metre and a radian
  EXPECT_EQ(row["unmatched"], 0);

  const auto again = rasterslam("relations run.gt.tum -o run.relations", folder.path());
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("--overwrite"));
  const auto long_step = rasterslam("relations run.gt.tum -o none.relations --step 1000", folder.path());
  EXPECT_EQ(long_step.exit_code, 3);
  EXPECT_THAT(long_step.err, HasSubstr("gives no relation"));
  EXPECT_FALSE(fs::exists(folder / "none.relations"));
  EXPECT_EQ(rasterslam("relations run.gt.tum --step 0", folder.path()).exit_code, 2);
}

TEST(CompareByRelations, ScoresEveryPathOnlineAndFinal) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat -o run.rawlog --duration 40 --seed 2 -q", folder.path()).exit_code, 0);
  ASSERT_EQ(rasterslam("relations run.gt.tum -o run.relations", folder.path()).exit_code, 0);
  // A real log has relations and no truth.
  fs::remove(folder / "run.gt.tum");
  fs::remove(folder / "run.rawlog.GT.txt");
  const std::string command =
      "compare run.rawlog --relations run.relations --methods naive_wheel,rbpf_exact -o ";
  const auto json = rasterslam(command + "one --json", folder.path());
  ASSERT_EQ(json.exit_code, 0) << json.err;
  const auto result = nlohmann::json::parse(json.out);
  const auto rows = result["relations"]["rows"];
  ASSERT_EQ(rows.size(), 3U);
  EXPECT_EQ(rows[0]["path"], "naive_wheel");
  EXPECT_EQ(rows[1]["path"], "rbpf_exact final");
  EXPECT_EQ(rows[2]["path"], "rbpf_exact online");
  for (const auto& row : rows) EXPECT_EQ(row["interpolated"], 0);
  EXPECT_LT(rows[1]["translation_mean_m"].get<double>(),
            0.1);  // a flat of 12 m: a particle filter is not lost
  EXPECT_GT(rows[1]["translation_mean_m"].get<double>(), 0);
  EXPECT_GT(result["worst_relations"]["rows"].size(), 2U);
  EXPECT_THAT(result["scores"]["caption"].get<std::string>(), HasSubstr("Beside the relations"));
  EXPECT_GT(result["scores"]["rows"][1]["on_wall_share"].get<double>(), 0.5);

  const auto text = rasterslam(command + "two --threads 2", folder.path());
  ASSERT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("Error against"));
  for (const char* file : {"relations.txt", "relations.csv", "relations.json", "worst_relations.csv"})
    EXPECT_EQ(resources::fileSha256(folder / ("one/" + std::string(file))),
              resources::fileSha256(folder / ("two/" + std::string(file))))
        << file;
  const auto run = rasterslam("eval two/rbpf_exact --relations run.relations --json", folder.path());
  EXPECT_EQ(nlohmann::json::parse(run.out)["relations"]["rows"].size(), 2U) << run.err;
}

TEST(CompareByRelations, RefusesRelationsOfAnotherLogBeforeItRunsAnything) {
  const testing::TempFolder folder;
  ASSERT_EQ(rasterslam("simulate flat -o run.rawlog --duration 5 -q", folder.path()).exit_code, 0);
  logs::writeRelations({{100, 200, {1, 0, 0}}}, folder / "other.relations");
  const auto other = rasterslam("compare run.rawlog --relations other.relations -o out -q", folder.path());
  EXPECT_EQ(other.exit_code, 3);
  EXPECT_THAT(other.err, HasSubstr("other.relations: no relation lies within the time of run.rawlog"));
  EXPECT_FALSE(fs::exists(folder / "out"));
  const auto plan = rasterslam("compare flat --relations other.relations -o out -q", folder.path());
  EXPECT_EQ(plan.exit_code, 3);
  EXPECT_THAT(plan.err, HasSubstr("--relations belongs to a log"));
}

}  // namespace
}  // namespace slam::apps
