#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/score/compare.h"
#include "libslam/score/evaluate.h"
#include "libslam/sim/operation_log.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::score {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::HasSubstr;

/// Asks to stop at the n-th report.
class StopAt : public core::Progress {
 public:
  explicit StopAt(int n) : left_(n) {}
  void update(double, double) override {
    if (--left_ == 0) throw core::Interrupted();
  }

 private:
  int left_;
};

record::RecordConfig shortRecording(double duration_s) {
  files::IniFile ini;
  ini.set("simulation", "duration_s", files::formatNumber(duration_s), "test");
  ini.set("lidar", "beams", "181", "test");
  return record::readRecordConfig(ini);
}

world::Plan flat() {
  return world::loadPlan(resources::resolvePlan("flat"));
}

TEST(Record, AnInterruptLeavesNothing) {
  const testing::TempFolder folder;
  StopAt progress(20);
  EXPECT_THROW(record::record(flat(), shortRecording(60), 1, folder / "run.rawlog", {}, progress),
               core::Interrupted);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Record, TheTruthHasOnePoseForEveryScanAndStartsWhereAsked) {
  const testing::TempFolder folder;
  const auto plan = flat();
  auto config = shortRecording(10);
  const auto start = world::findStartPose(plan, 0.6);
  ASSERT_TRUE(start.has_value());
  config.simulation.start = files::formatNumber(start->x) + " " + files::formatNumber(start->y) + " 90";
  const auto recording = record::record(plan, config, 1, folder / "run.rawlog", {}, core::silentProgress());
  const auto truth = logs::readTum(folder / "run.gt.tum");
  EXPECT_EQ(recording.scans, 51U);  // 10 s at 5 Hz and the first look
  EXPECT_EQ(truth.size(), recording.scans);
  EXPECT_NEAR(truth.front().pose.x, start->x, 1e-9);
  EXPECT_NEAR(truth.front().pose.phi, core::kPi / 2, 1e-8);
  EXPECT_NEAR(recording.path_length_m, core::pathLength(truth), 1e-6);
  EXPECT_NEAR(recording.duration_s, 10, 1e-9);
  // Every scan after the first belongs to one operation or to none, and some to each.
  const std::string path = folder / "run.operations.txt";
  const auto commands = sim::commandsOfScans(sim::parseOperations(files::readTextFile(path), path), 51, path);
  const auto covered = std::count_if(commands.begin(), commands.end(), [](const robot::Commanded& commanded) {
    return commanded.kind == robot::MotionKind::kMove || commanded.kind == robot::MotionKind::kTurn;
  });
  EXPECT_GT(covered, 40);
}

// The bytes that seed 1 gives; kept over build types and numbers of threads. They may only change with a
// commit that says why, since every published table of an older version changes with them.
TEST(Record, HasGoldenBytes) {
  const testing::TempFolder folder;
  record::record(flat(), shortRecording(30), 1, folder / "run.rawlog", {}, core::silentProgress());
  EXPECT_EQ(resources::fileSha256(folder / "run.rawlog"),
            "b8048fb57c423525c8743e9cec4f247392408ad17839b83c850aaf12391a449a");
  EXPECT_EQ(resources::fileSha256(folder / "run.gt.tum"),
            "a93638bc38535140d572f7c2786ebdc053e793376c88ce31e38614ee341ab9ae");
  for (const auto& [method, golden] : std::map<std::string, std::string>{
           {"naive", "34bd4e2b9fb593867eb7fb2d9fcbbc480bc62f313b7c6e6fa646ea772e9f85fe"},
           {"icp", "02179186ceab70fb37a3fa7e4bc49d31a4dea19c516e43aae1033d24808a0052"},
           {"rbpf_exact", "56e937022ab6afc9ce1c49c8aeb61aede6c3f0fe9a8f241309387c460cc96464"}}) {
    const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", method);
    run::buildMap(folder / "run.rawlog", config, method, 1, folder / method, false, {},
                  core::silentProgress());
    EXPECT_EQ(resources::sha256(resources::fileSha256(folder / (method + "/trajectory.tum")) +
                                resources::fileSha256(folder / (method + "/map.png"))),
              golden)
        << method;
  }
}

TEST(BuildMap, AnInterruptLeavesNothing) {
  const testing::TempFolder folder;
  record::record(flat(), shortRecording(6), 1, folder / "run.rawlog", {}, core::silentProgress());
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive");
  StopAt progress(10);
  EXPECT_THROW(run::buildMap(folder / "run.rawlog", config, "naive", 1, folder / "out", false, {}, progress),
               core::Interrupted);
  EXPECT_FALSE(fs::exists(folder / "out"));
  EXPECT_THAT(testing::leftoversIn(folder.path()), ::testing::IsEmpty());
}

TEST(Evaluate, AFailedMethodHasARowOfNothing) {
  Truth truth;
  truth.plan = world::Plan{};
  const auto table = accuracyTable({failedEvaluation("icp", "diverged at scan 3")}, truth, Detail::kFull);
  ASSERT_EQ(table.rows.size(), 1U);
  for (size_t i = 1; i < table.columns.size(); ++i)
    EXPECT_TRUE(std::isnan(std::get<double>(table.rows[0][i])));
  EXPECT_THAT(table.notes.back(), HasSubstr("icp failed: diverged at scan 3"));
}

TEST(Compare, AMethodThatFailsDoesNotTakeTheOthersWithIt) {
  const testing::TempFolder folder;
  auto tiny = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "rbpf");
  CompareRequest request;
  request.plan_path = resources::resolvePlan("flat");
  request.record = shortRecording(6);
  request.methods_folder = resources::configsFolder() + "/methods";
  // A limit that the first map already breaks stands for a filter that diverges.
  const std::string rbpf = files::readTextFile(request.methods_folder + "/rbpf.ini");
  files::writeFileAtomically(
      folder / "cramped.ini",
      std::string(rbpf).replace(rbpf.find("[mapping]"), 9, "[mapping]\nmax_map_cells = 10000"));
  request.methods = {folder / "cramped.ini", "naive_wheel"};
  request.output = folder / "out";
  const auto comparison = compare(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.failed, 1);
  ASSERT_EQ(comparison.evaluations.size(), 2U);
  EXPECT_NE(comparison.evaluations[0].failure, "");
  EXPECT_TRUE(std::isfinite(comparison.evaluations[1].trajectory.position_m.rmse));
  EXPECT_FALSE(fs::exists(folder / "out/cramped"));
  EXPECT_TRUE(fs::exists(folder / "out/maps.png"));
}

TEST(Compare, ResumeReusesTheRunsOfTheSameSeedOnly) {
  const testing::TempFolder folder;
  record::record(flat(), shortRecording(4), 1, folder / "run.rawlog", {}, core::silentProgress());
  CompareRequest request;
  request.log_path = folder / "run.rawlog";
  request.methods_folder = resources::configsFolder() + "/methods";
  request.methods = {"naive_wheel"};
  request.output = folder / "out";
  EXPECT_EQ(compare(request, {}, core::silentProgress()).reused, 0);
  request.resume = true;
  EXPECT_EQ(compare(request, {}, core::silentProgress()).reused, 1);
  request.seed = 2;
  EXPECT_EQ(compare(request, {}, core::silentProgress()).reused, 0);
}

TEST(Resources, NamesAreNotPathsAndPathsAreNotNames) {
  EXPECT_THAT(resources::resolvePlan("maze"), HasSubstr("maze.yaml"));
  EXPECT_EQ(errorOf([] { resources::resolvePlan("./maze"); }), "./maze: no such file");
  EXPECT_THAT(errorOf([] { resources::resolvePlan("mazze"); }), HasSubstr("did you mean 'maze'?"));
  EXPECT_TRUE(resources::looksLikePlan("some/PLAN.PNG"));
  EXPECT_FALSE(resources::looksLikePlan("run.rawlog"));
}

// Every configuration that is shipped can be loaded: a misspelt key in one of them would be found here.
TEST(Resources, EveryShippedMethodAndWorldLoads) {
  const std::string methods = resources::configsFolder() + "/methods";
  EXPECT_GE(resources::namesInFolder(methods, ".ini").size(), 6U);
  for (const auto& name : resources::namesInFolder(methods, ".ini"))
    EXPECT_NO_THROW(mapping::makeMapBuilder(mapping::loadMethodConfig(methods, name), name, 1)) << name;
  for (const auto& name : resources::namesInFolder(resources::worldsFolder(), ".yaml"))
    EXPECT_NO_THROW(world::loadPlan(resources::resolvePlan(name))) << name;
}

}  // namespace
}  // namespace slam::score
