#include "libslam/truth/cut_truth.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/manifest.h"
#include "libslam/testing/temp_folder.h"
#include "libslam/truth/number_rows.h"
#include "libslam/truth/truth_files.h"
#include "tests/logs/log_fixtures.h"

namespace slam::truth {
namespace {
namespace fs = std::filesystem;

/// A log of 20 scans, its truth ten times as dense, and the plan that it names.
struct Whole {
  testing::TempFolder folder;
  std::string log = folder / "whole.rawlog", part = folder / "part.rawlog", plan = folder / "plan.yaml";
  std::vector<logs::LogEntry> entries = logs::sampleEntries(20);
  Whole() {
    logs::writeLog(entries, log, rawlogs::RawlogForm::kActionFrame);
    core::Trajectory truth;
    const double first_s = timeOf(0), last_s = timeOf(entries.size() - 1);
    for (double s = first_s - 1; s < last_s + 1; s += (last_s - first_s) / 190)
      truth.push_back({s, {s - first_s, 0, 0}});
    truth.push_back({last_s + 2, {99, 0, 0}});
    logs::writeTum(truth, folder / "whole.gt.tum");
    files::writeFileAtomically(plan, "a plan");
    resources::Manifest manifest;
    manifest.inputs[plan] = resources::fileSha256(plan);
    resources::writeManifest(manifest, folder / "whole.manifest.json");
  }
  double timeOf(size_t entry) const { return entries[entry].scan.time_s; }
  void cut(size_t first, size_t end) {
    logs::writeLog({entries.begin() + static_cast<long>(first), entries.begin() + static_cast<long>(end)},
                   part, rawlogs::RawlogForm::kActionFrame);
  }
};

TEST(CutTruth, IsThatOfThePartsTime) {
  Whole whole;
  whole.cut(5, 9);
  const auto written = keepTruth(whole.log, whole.part);
  ASSERT_EQ(written.size(), 2U);
  EXPECT_EQ(written[0], whole.folder / "part.gt.tum");
  const auto truth = logs::readTrajectory(written[0]);
  ASSERT_GT(truth.size(), 3U);
  EXPECT_GE(truth.front().time_s, whole.timeOf(5) - 1e-5);
  EXPECT_LE(truth.back().time_s, whole.timeOf(8) + 1e-5);
  // Both ends: no more than a step of the truth is missing there.
  const double step_s = (whole.timeOf(19) - whole.timeOf(0)) / 190;
  EXPECT_LT(truth.front().time_s, whole.timeOf(5) + step_s);
  EXPECT_GT(truth.back().time_s, whole.timeOf(8) - step_s);
  EXPECT_EQ(findTruth(whole.part), written[0]);
  EXPECT_EQ(findPlan(whole.part), whole.plan);
}

TEST(CutTruth, IsNothingWhereThereIsNone) {
  Whole whole;
  whole.cut(0, 3);
  fs::remove(whole.folder / "whole.gt.tum");
  EXPECT_TRUE(keepTruth(whole.log, whole.part).empty());
  EXPECT_FALSE(fs::exists(whole.folder / "part.gt.tum"));
  // MRPT's own form has no world frame.
  files::writeFileAtomically(whole.log + ".GT.txt", "0 0 0 0\n");
  EXPECT_TRUE(keepTruth(whole.log, whole.part).empty());
}

TEST(CutTruth, WithoutAPlanItIsTheTruthAlone) {
  Whole whole;
  whole.cut(0, 3);
  files::writeFileAtomically(whole.plan, "another plan");  // no longer what was driven in
  EXPECT_EQ(keepTruth(whole.log, whole.part), std::vector<std::string>{whole.folder / "part.gt.tum"});
}

TEST(TruthFiles, TheNearestOfTheNamesIsTaken) {
  const testing::TempFolder folder;
  const std::string log = folder / "run.rawlog";
  EXPECT_EQ(findTruth(log), "");
  for (const char* name : {"run.rawlog.GT.txt", "run.truth.tum", "run.gt.tum"}) {
    files::writeFileAtomically(folder / name, "0 0 0 0 0 0 0 1\n");
    EXPECT_EQ(findTruth(log), folder / name) << "before those that were there";
  }
}

TEST(TruthFiles, WhatIsGivenCountsAndAPlanOnlyWithAWorldFrame) {
  Whole whole;
  auto files = truthFiles(whole.log, "", "");
  EXPECT_EQ(files.trajectory, whole.folder / "whole.gt.tum");
  EXPECT_EQ(files.plan, whole.plan);
  files = truthFiles(whole.log, "mine.tum", "mine.png");
  EXPECT_EQ(files.trajectory, "mine.tum");
  EXPECT_EQ(files.plan, "mine.png");
  files = truthFiles(whole.log, "mine.GT.txt", "");
  EXPECT_EQ(files.plan, "") << "it starts at the origin, wherever that is";
  files = truthFiles(whole.folder / "other.rawlog", "", "mine.png");
  EXPECT_EQ(files.trajectory, "");
  EXPECT_EQ(files.plan, "");
}

TEST(TruthFiles, LieBesideALogOfAnyName) {
  EXPECT_EQ(besideLog("a/run.rawlog", ".x.csv"), "a/run.x.csv");
  EXPECT_EQ(besideLog("a/run.gt.tum", ".x.csv"), "a/run.x.csv");
  EXPECT_EQ(besideLog("a/run.rawlog.GT.txt", ".x.csv"), "a/run.x.csv");
  EXPECT_EQ(besideLog("a/run.2.rawlog", ".x.csv"), "a/run.2.x.csv");
  EXPECT_EQ(besideLog("a/run.log", ".x.csv"), "a/run.log.x.csv");
  EXPECT_EQ(besideLog("a.b/run", ".x.csv"), "a.b/run.x.csv");
  EXPECT_EQ(besideLog("a.b/run.rawlog", ""), "a.b/run");
}

}  // namespace
}  // namespace slam::truth
