// A method that fails on the way, and an interrupt: what was mapped before is kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/log_writer.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/score/compare.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/temp_folder.h"

namespace slam::run {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

constexpr int kBadScan = 60;

/// A log of the flat whose odometry jumps a thousand kilometres at scan kBadScan, where no grid can follow;
/// and its first part alone.
class BrokenOdometry : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "20", "test");
    ini.set("lidar", "beams", "181", "test");
    const std::string whole = *shared_folder / "whole.rawlog";
    record::record(world::loadPlan(resources::resolvePlan("flat")), record::readRecordConfig(ini), 1, whole,
                   {}, core::silentProgress());
    logs::LogReader log(whole);
    logs::LogWriter bad(*shared_folder / "bad.rawlog", rawlogs::RawlogForm::kActionFrame);
    logs::LogWriter first(*shared_folder / "first.rawlog", rawlogs::RawlogForm::kActionFrame);
    for (int i = 0; auto entry = log.next(); ++i) {
      if (i < kBadScan) first.write(*entry);
      if (i == kBadScan) entry->T_previous_robot.x = 1e6;
      bad.write(*entry);
    }
    bad.close();
    first.close();
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  static MapRun build(const std::string& method, const std::string& log, const std::string& output,
                      core::Progress& progress = core::silentProgress(), bool keep_partial = false) {
    const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", method);
    return buildMap(*shared_folder / (log + ".rawlog"), config, method, 1, *shared_folder / output, true, {},
                    progress, {false, {}, nullptr, keep_partial});
  }
  static testing::TempFolder* shared_folder;
};
testing::TempFolder* BrokenOdometry::shared_folder = nullptr;

TEST_F(BrokenOdometry, WhatWasMappedBeforeIsKept) {
  for (const std::string method : {"particles", "icp", "rbpf", "naive_wheel"}) {
    const auto run = build(method, "bad", method);
    ASSERT_TRUE(run.stopped.has_value()) << method;
    EXPECT_EQ(run.stopped->reason, results::Stop::Reason::kFailed);
    EXPECT_EQ(run.stopped->scan, kBadScan) << method;
    EXPECT_THAT(run.stopped->why, HasSubstr("the map would hold")) << method;
    const auto partial = results::loadRun(*shared_folder / method);
    EXPECT_EQ(partial.estimate.size(), static_cast<size_t>(kBadScan)) << method;
    EXPECT_EQ(partial.manifest.results.at("status"), "incomplete");
    EXPECT_THAT(partial.manifest.results.at("failed"), HasSubstr("at scan 60 (12.0 s): "));
    const auto journal = results::readJournal(*shared_folder / (method + "/journal.csv"));
    EXPECT_EQ(journal.back().event, core::JournalEvent::kFailed) << method;
    EXPECT_EQ(journal.back().scan, kBadScan - 1);
    EXPECT_THAT(journal.back().detail, HasSubstr("the map would hold"));
    for (const char* file : {"map.yaml", "map.png", "map.gridmap.gz", "map.simplemap", "map.3Dscene"})
      EXPECT_TRUE(fs::exists(*shared_folder / (method + "/" + file))) << method << " " << file;
    // A method that gives its path as it goes has mapped what it maps of the first part alone.
    build(method, "first", method + "_first");
    EXPECT_EQ(resources::fileSha256(*shared_folder / (method + "/trajectory.tum")),
              resources::fileSha256(*shared_folder / (method + "_first/trajectory.tum")))
        << method;
  }
}

TEST_F(BrokenOdometry, AComparisonHasARowThatSaysWhereAndKeepsTheFolder) {
  score::CompareRequest request;
  request.log_path = *shared_folder / "bad.rawlog";
  request.methods_folder = resources::configsFolder() + "/methods";
  request.methods = {"naive_wheel", "icp"};
  request.output = *shared_folder / "compared";
  const auto comparison = score::compare(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.failed, 2);
  EXPECT_THAT(comparison.evaluations[1].failure, HasSubstr("at scan 60 (12.0 s): "));
  EXPECT_TRUE(std::isnan(comparison.evaluations[1].path_length_m));
  EXPECT_TRUE(fs::exists(*shared_folder / "compared/icp/map.png"));
  EXPECT_THAT(files::readTextFile(*shared_folder / "compared/scores.txt"),
              HasSubstr("icp failed: at scan 60"));
}

TEST_F(BrokenOdometry, AMapThatCannotBeDrawnLeavesItsPathAndKeyFrames) {
  auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "graph");
  config.setFromArgument("mapping.max_map_cells=10000", "test");
  const auto run = buildMap(*shared_folder / "first.rawlog", config, "graph", 1, *shared_folder / "undrawn",
                            true, {}, core::silentProgress(), {false});
  ASSERT_TRUE(run.stopped.has_value());
  EXPECT_THAT(run.stopped->why, HasSubstr("max_map_cells"));
  EXPECT_EQ(logs::readTum(*shared_folder / "undrawn/trajectory_final.tum").size(),
            static_cast<size_t>(kBadScan));
  EXPECT_TRUE(fs::exists(*shared_folder / "undrawn/map.simplemap"));
  const auto manifest = resources::readManifest(*shared_folder / "undrawn/manifest.json");
  EXPECT_EQ(manifest.files.count("map.png"), 0U);
  EXPECT_EQ(manifest.files.count("map.simplemap"), 1U);
}

/// Asks to stop at the n-th report and from then on.
class StopAt : public core::Progress {
 public:
  explicit StopAt(int n) : left_(n) {}
  void update(double, double) override {
    if (--left_ <= 0) throw core::Interrupted();
  }

 private:
  int left_;
};

TEST_F(BrokenOdometry, AnInterruptKeepsWhatIsThereWhenAskedTo) {
  StopAt progress(20);
  const auto run = build("icp", "first", "interrupted", progress, true);
  ASSERT_TRUE(run.stopped.has_value());
  EXPECT_EQ(run.stopped->reason, results::Stop::Reason::kInterrupted);
  const auto partial = results::loadRun(*shared_folder / "interrupted");
  EXPECT_EQ(partial.estimate.size(), 20U);
  EXPECT_EQ(partial.manifest.results.at("interrupted"), "at scan 20 (3.8 s)");
  EXPECT_EQ(results::readJournal(*shared_folder / "interrupted/journal.csv").back().event,
            core::JournalEvent::kInterrupted);
  StopAt again(20);
  EXPECT_THROW(build("icp", "first", "not kept", again), core::Interrupted);
  EXPECT_FALSE(fs::exists(*shared_folder / "not kept"));
}

}  // namespace
}  // namespace slam::run
