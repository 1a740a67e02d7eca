// A map of one log gone on with, or only used, by the next.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/log_writer.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/score/compare.h"
#include "libslam/score/evaluate.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::run {
namespace {
using slam::testing::errorOf;
using ::testing::HasSubstr;

/// A log of the flat, whole and as two halves.
class TwoHalves : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new testing::TempFolder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "40", "test");
    ini.set("lidar", "beams", "181", "test");
    const std::string whole = *folder_ / "whole.rawlog";
    record::record(world::loadPlan(resources::resolvePlan("flat")), record::readRecordConfig(ini), 1, whole,
                   {}, core::silentProgress());
    logs::LogReader log(whole);
    logs::LogWriter first(*folder_ / "first.rawlog", rawlogs::RawlogForm::kActionFrame);
    logs::LogWriter second(*folder_ / "second.rawlog", rawlogs::RawlogForm::kActionFrame);
    for (int i = 0; const auto entry = log.next(); ++i) (i < 100 ? first : second).write(*entry);
    first.close();
    second.close();
    whole_ = build("graph", "whole", {});
    build("graph", "first", {});
  }
  static void TearDownTestSuite() {
    delete folder_;
    folder_ = nullptr;
  }
  static core::Pose2 build(const std::string& method, const std::string& log,
                           const Continuation& continuation, const std::string& output = "") {
    const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", method);
    const std::string folder = *folder_ / (output.empty() ? log : output);
    buildMap(*folder_ / (log + ".rawlog"), config, method, 1, folder, true, {}, core::silentProgress(),
             {false, continuation});
    return endOfRun(folder);
  }
  static testing::TempFolder* folder_;
  static core::Pose2 whole_;
};
testing::TempFolder* TwoHalves::folder_ = nullptr;
core::Pose2 TwoHalves::whole_;

TEST_F(TwoHalves, ContinuedEndsWhereTheWholeDoes) {
  const auto end = build("graph", "second", {*folder_ / "first", false, {}}, "both");
  // Each closes the same loops in another order; the flat's walls hold both to a few millimetres.
  EXPECT_LT(core::distance(end, whole_), 0.03);
  EXPECT_LT(std::abs(core::angleDifference(end.phi, whole_.phi)), core::degToRad(0.5));
  const auto manifest = resources::readManifest(*folder_ / "both/manifest.json");
  EXPECT_EQ(manifest.results.at("continues"), *folder_ / "first");
  EXPECT_EQ(manifest.inputs.count(*folder_ / "first/map.simplemap"), 1U);
  EXPECT_NE(resources::fileSha256(*folder_ / "both/map.png"),
            resources::fileSha256(*folder_ / "first/map.png"));
}

TEST_F(TwoHalves, OfOtherMethodsToo) {
  for (const std::string method : {"icp", "particles"}) {
    build(method, "first", {}, method + "_first");
    const auto end = build(method, "second", {*folder_ / (method + "_first"), false, {}}, method + "_both");
    EXPECT_LT(core::distance(end, whole_), 0.15) << method;
  }
}

TEST_F(TwoHalves, LocalisingKeepsTheMapsBytes) {
  const auto end =
      build("graph", "second", {*folder_ / "whole", true, endOfRun(*folder_ / "first")}, "localised");
  EXPECT_LT(core::distance(end, whole_), 0.03);
  for (const std::string file : {"map.yaml", "map.png", "map.gridmap.gz", "map.simplemap"})
    EXPECT_EQ(resources::fileSha256(*folder_ / ("localised/" + file)),
              resources::fileSha256(*folder_ / ("whole/" + file)))
        << file;
  EXPECT_EQ(resources::readManifest(*folder_ / "localised/manifest.json").results.at("localised_in"),
            *folder_ / "whole");
}

TEST_F(TwoHalves, AStartElsewhereIsTaken) {
  core::Pose2 moved = endOfRun(*folder_ / "first");
  moved.x += 0.05;
  build("icp", "first", {}, "icp_first");
  build("icp", "second", {*folder_ / "icp_first", true, moved}, "moved");
  const auto manifest = resources::readManifest(*folder_ / "moved/manifest.json");
  EXPECT_EQ(manifest.results.at("start.x_m"), files::formatNumber(moved.x));
}

TEST_F(TwoHalves, MethodsThatCannotSaySo) {
  for (const std::string method : {"naive", "rbpf"})
    EXPECT_THAT(errorOf([&] {
                  build(method, "second", {*folder_ / "first", false, {}}, "x");
                }),
                HasSubstr("cannot go on in a map, expected type icp, particles or graph"));
  EXPECT_THAT(errorOf([&] {
                build("graph", "second", {*folder_ / "nowhere", false, {}}, "x");
              }),
              HasSubstr("nowhere/manifest.json: no such file"));
  build("graph", "first", {}, "broken");
  files::writeFileAtomically(*folder_ / "broken/map.simplemap", "not a map");
  EXPECT_THAT(errorOf([&] {
                build("graph", "second", {*folder_ / "broken", false, {}}, "x");
              }),
              HasSubstr("broken/map.simplemap: is no MRPT simplemap"));
  EXPECT_FALSE(std::filesystem::exists(*folder_ / "x"));
}

// Intel's stamps run back, so that the path through trajectory.tum, which is in the order of stamps, goes
// back and forth.
TEST_F(TwoHalves, LengthAndEndAreThoseOfTheLogsOrder) {
  auto run = results::loadRun(*folder_ / "whole");
  const auto as_run = score::evaluate(run, {});
  std::swap(run.estimate[20].pose, run.estimate[90].pose);
  std::swap(run.estimate.front().pose, run.estimate.back().pose);
  const auto shuffled = score::evaluate(run, {});
  EXPECT_EQ(shuffled.path_length_m, as_run.path_length_m);
  EXPECT_EQ(shuffled.end_pose.x, as_run.end_pose.x);
  EXPECT_NEAR(as_run.end_pose.x, whole_.x, 0.05);
  for (const char* key : {"path_length_m", "end.x_m"}) run.manifest.results.erase(key);
  EXPECT_GT(score::evaluate(run, {}).path_length_m, as_run.path_length_m + 1);
}

TEST_F(TwoHalves, ARunThatEndsLostHasItsFiguresAndANote) {
  auto run = results::loadRun(*folder_ / "whole");
  run.manifest.results["lost"] = "lost at scan 90 (18.0 s)";
  const auto evaluation = score::evaluate(run, {});
  EXPECT_GT(evaluation.path_length_m, 1);
  EXPECT_THAT(score::agreementTable({evaluation}, score::Detail::kShort).notes[1],
              HasSubstr("graph failed: lost at scan 90 (18.0 s)"));
}

// `rasterslam run` ends with exit code 4 then; the files are all there.
TEST_F(TwoHalves, AComparisonShowsTheFiguresOfARunThatEndsLost) {
  const std::string program = *folder_ / "lost.sh";
  files::writeFileAtomically(program,
                             "#!/bin/sh\n"
                             "cp -r '" +
                                 (*folder_ / "whole") + "' \"$5\"\n" +
                                 R"(sed -i 's/"results": {/&"lost": "lost at scan 90",/' "$5/manifest.json")"
                                 "\n" +
                                 R"(echo '{"lost": "lost at scan 90"}')"
                                 "\nexit 4\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  score::CompareRequest request;
  request.log_path = *folder_ / "whole.rawlog";
  request.methods_folder = resources::configsFolder() + "/methods";
  request.methods = {"graph"};
  request.output = *folder_ / "compared";
  request.program = program;
  const auto comparison = score::compare(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.failed, 1);
  EXPECT_EQ(comparison.evaluations[0].failure, "lost at scan 90");
  EXPECT_LT(comparison.evaluations[0].trajectory.position_m.rmse, 0.1);
}

}  // namespace
}  // namespace slam::run
