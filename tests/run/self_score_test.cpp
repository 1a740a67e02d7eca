#include "libslam/results/self_score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/log_writer.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/temp_folder.h"

namespace slam::run {
namespace {

/// A minute in the flat, its log and its true path.
class SelfScoring : public ::testing::Test {
 protected:
  void SetUp() override {
    files::IniFile ini;
    ini.set("simulation", "duration_s", "60", "test");
    ini.set("lidar", "beams", "181", "test");
    record::record(plan_, record::readRecordConfig(ini), 1, log_, {}, core::silentProgress());
    truth_ = logs::readTum(folder_ / "run.gt.tum");
  }
  results::SelfScore scoreOf(const core::Trajectory& path) const {
    return results::selfScore(log_, path, plan_, core::silentProgress());
  }

  testing::TempFolder folder_;
  world::Plan plan_ = world::loadPlan(resources::resolvePlan("flat"));
  std::string log_ = folder_ / "run.rawlog";
  core::Trajectory truth_;
};

TEST_F(SelfScoring, TruePosesOnTheTruePlanAgreeAndDriftingOnesDoNot) {
  const auto at_truth = scoreOf(truth_);
  EXPECT_GT(at_truth.agreement.on_wall_share, 0.99);
  EXPECT_LT(at_truth.agreement.through_wall_share, 0.01);
  // The lidar's noise of 1 cm, and corners and furniture within the neighbourhoods.
  EXPECT_LT(at_truth.sharpness.wall_thickness_m, 0.04);
  core::Trajectory drifting = truth_;
  for (auto& [time_s, pose] : drifting)
    pose = pose * core::Pose2{0, 0, 0.002 * (time_s - truth_.front().time_s)};  // 7 degrees in the end
  const auto adrift = scoreOf(drifting);
  EXPECT_LT(adrift.agreement.on_wall_share, at_truth.agreement.on_wall_share - 0.1);
  EXPECT_GT(adrift.agreement.through_wall_share, at_truth.agreement.through_wall_share + 0.05);
  EXPECT_GT(adrift.sharpness.wall_thickness_m, 1.5 * at_truth.sharpness.wall_thickness_m);
  EXPECT_GT(adrift.sharpness.mean_map_entropy, at_truth.sharpness.mean_map_entropy + 0.2);
}

TEST_F(SelfScoring, WantsOnePoseForEveryScan) {
  core::Trajectory path = truth_;
  path.pop_back();
  EXPECT_THROW(scoreOf(path), core::ContractError);
  path = truth_;
  path.push_back(path.back());
  EXPECT_THROW(scoreOf(path), core::ContractError);
}

TEST_F(SelfScoring, OfKeptScansIsThatOfTheLog) {
  logs::KeptScans kept(folder_.path());
  logs::LogReader reader(log_);
  while (const auto entry = reader.next()) kept.add(*entry);
  ASSERT_TRUE(kept.rewind());
  const auto of_kept = results::selfScore(kept, truth_, plan_, core::silentProgress()),
             of_log = scoreOf(truth_);
  EXPECT_EQ(of_kept.sharpness.mean_map_entropy, of_log.sharpness.mean_map_entropy);
  EXPECT_EQ(of_kept.sharpness.points, of_log.sharpness.points);
  EXPECT_EQ(of_kept.agreement.on_wall_share, of_log.agreement.on_wall_share);
  EXPECT_EQ(of_kept.agreement.returns, of_log.agreement.returns);

  core::Trajectory path = truth_;
  path.pop_back();
  ASSERT_TRUE(kept.rewind());
  EXPECT_THROW(results::selfScore(kept, path, plan_, core::silentProgress()), core::ContractError);
}

TEST_F(SelfScoring, StandsInEveryRunAndInItsTable) {
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "rbpf_exact");
  const auto run =
      buildMap(log_, config, "rbpf_exact", 1, folder_ / "out", false, {}, core::silentProgress());
  ASSERT_TRUE(run.final_estimate.has_value());
  const auto loaded = results::loadRun(folder_ / "out");
  ASSERT_TRUE(loaded.final_estimate.has_value());
  EXPECT_EQ(loaded.final_estimate->size(), loaded.estimate.size());
  const auto evaluation = score::evaluate(loaded, std::nullopt);
  EXPECT_GT(evaluation.on_wall_share, 0.8);
  EXPECT_GT(evaluation.wall_thickness_m, 0);
  EXPECT_LT(evaluation.wall_thickness_m, 0.1);
  EXPECT_GT(evaluation.structure.corners, 4U);
  const auto table = score::agreementTable({evaluation}, score::Detail::kShort);
  for (size_t i = 1; i < table.columns.size(); ++i)
    EXPECT_EQ(std::isfinite(std::get<double>(table.rows[0][i])),
              table.columns[i].key != "agreement_m")  // nobody to agree with
        << table.columns[i].key;
  EXPECT_GT(score::agreementTable({evaluation}, score::Detail::kFull).columns.size(), table.columns.size());
}

TEST_F(SelfScoring, WhileTheMapIsWrittenGivesTheSameBytes) {
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "graph");
  BuildOptions options;
  for (const int threads : {1, 2}) {
    options.threads = threads;
    buildMap(log_, config, "graph", 1, folder_ / std::to_string(threads), false, {}, core::silentProgress(),
             options);
  }
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "1")) {
    const std::string name = entry.path().filename().string();
    if (name == "timing.csv" || name == "manifest.json") continue;
    EXPECT_EQ(resources::fileSha256(folder_ / ("2/" + name)), resources::fileSha256(entry.path().string()))
        << name;
    ++files;
  }
  EXPECT_GT(files, 8);
  const auto one = results::loadRun(folder_ / "1").manifest.results,
             two = results::loadRun(folder_ / "2").manifest.results;
  EXPECT_EQ(two.at("self.on_wall_share"), one.at("self.on_wall_share"));
}

// A run of another version, or an exploration, has no such figures: the table says so and the rest stands.
TEST_F(SelfScoring, IsNotMissedWhereARunDoesNotHaveIt) {
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive_wheel");
  buildMap(log_, config, "naive_wheel", 1, folder_ / "out", false, {}, core::silentProgress());
  auto loaded = results::loadRun(folder_ / "out");
  EXPECT_FALSE(loaded.final_estimate.has_value());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/trajectory_final.tum"));
  auto& results = loaded.manifest.results;
  for (auto it = results.begin(); it != results.end();)
    it = it->first.rfind("self.", 0) == 0 ? results.erase(it) : std::next(it);
  const auto evaluation = score::evaluate(loaded, std::nullopt);
  EXPECT_TRUE(std::isnan(evaluation.on_wall_share));
  EXPECT_TRUE(std::isnan(evaluation.mean_map_entropy));
  EXPECT_TRUE(std::isfinite(evaluation.path_length_m));
}

// 631 scans of the Intel log carry a stamp earlier than the line before.
TEST_F(SelfScoring, ALogWhoseStampsRunBackGivesAPathInTheOrderOfTheStamps) {
  const std::string shuffled = folder_ / "shuffled.rawlog";
  logs::LogReader reader(log_);
  logs::LogWriter writer(shuffled, rawlogs::RawlogForm::kActionFrame);
  size_t index = 0;
  while (auto entry = reader.next()) {
    if (index++ % 20 == 7) entry->scan.time_s -= 0.3;  // before the scan before
    writer.write(*entry);
  }
  writer.close();
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive_wheel");
  const auto run =
      buildMap(shuffled, config, "naive_wheel", 1, folder_ / "out", false, {}, core::silentProgress());
  const auto byStamp = [](const auto& a, const auto& b) { return a.time_s < b.time_s; };
  EXPECT_TRUE(std::is_sorted(run.estimate.begin(), run.estimate.end(), byStamp));
  EXPECT_EQ(results::loadRun(folder_ / "out").estimate.size(), run.estimate.size());
  // Every scan was still placed at its own pose: the same figures as of the log whose stamps do not run back.
  buildMap(log_, config, "naive_wheel", 1, folder_ / "straight", false, {}, core::silentProgress());
  for (const char* key : {"self.on_wall_share", "self.wall_thickness_m"})
    EXPECT_EQ(results::loadRun(folder_ / "out").manifest.results.at(key),
              results::loadRun(folder_ / "straight").manifest.results.at(key))
        << key;
}

}  // namespace
}  // namespace slam::run
