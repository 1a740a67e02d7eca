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
    shared_folder = new testing::TempFolder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "40", "test");
    ini.set("lidar", "beams", "181", "test");
    const std::string whole = *shared_folder / "whole.rawlog";
    record::record(world::loadPlan(resources::resolvePlan("flat")), record::readRecordConfig(ini), 1, whole,
                   {}, core::silentProgress());
    logs::LogReader log(whole);
    logs::LogWriter first(*shared_folder / "first.rawlog", rawlogs::RawlogForm::kActionFrame);
    logs::LogWriter second(*shared_folder / "second.rawlog", rawlogs::RawlogForm::kActionFrame);
    for (int i = 0; const auto entry = log.next(); ++i) (i < 100 ? first : second).write(*entry);
    first.close();
    second.close();
    whole_end = build("graph", "whole", {});
    build("graph", "first", {});
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  static core::Pose2 build(const std::string& method, const std::string& log,
                           const Continuation& continuation, const std::string& output = "") {
    const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", method);
    const std::string folder = *shared_folder / (output.empty() ? log : output);
    buildMap(*shared_folder / (log + ".rawlog"), config, method, 1, folder, true, {}, core::silentProgress(),
             {false, continuation});
    return endOfRun(folder);
  }
  static testing::TempFolder* shared_folder;
  static core::Pose2 whole_end;
};
testing::TempFolder* TwoHalves::shared_folder = nullptr;
core::Pose2 TwoHalves::whole_end;

TEST_F(TwoHalves, ContinuedEndsWhereTheWholeDoes) {
  const auto end = build("graph", "second", {*shared_folder / "first", false, {}}, "both");
  // Each closes the same loops in another order; the flat's walls hold both to a few millimetres.
  EXPECT_LT(core::distance(end, whole_end), 0.03);
  EXPECT_LT(std::abs(core::angleDifference(end.phi, whole_end.phi)), core::degToRad(0.5));
  const auto manifest = resources::readManifest(*shared_folder / "both/manifest.json");
  EXPECT_EQ(manifest.results.at("continues"), *shared_folder / "first");
  EXPECT_EQ(manifest.inputs.count(*shared_folder / "first/map.simplemap"), 1U);
  EXPECT_NE(resources::fileSha256(*shared_folder / "both/map.png"),
            resources::fileSha256(*shared_folder / "first/map.png"));
}

TEST_F(TwoHalves, OfOtherMethodsToo) {
  for (const std::string method : {"icp", "particles"}) {
    build(method, "first", {}, method + "_first");
    const auto end =
        build(method, "second", {*shared_folder / (method + "_first"), false, {}}, method + "_both");
    EXPECT_LT(core::distance(end, whole_end), 0.15) << method;
  }
}

TEST_F(TwoHalves, LocalisingKeepsTheMapsBytes) {
  const auto end = build("graph", "second",
                         {*shared_folder / "whole", true, endOfRun(*shared_folder / "first")}, "localised");
  EXPECT_LT(core::distance(end, whole_end), 0.03);
  for (const std::string file : {"map.yaml", "map.png", "map.gridmap.gz", "map.simplemap"})
    EXPECT_EQ(resources::fileSha256(*shared_folder / ("localised/" + file)),
              resources::fileSha256(*shared_folder / ("whole/" + file)))
        << file;
  EXPECT_EQ(resources::readManifest(*shared_folder / "localised/manifest.json").results.at("localised_in"),
            *shared_folder / "whole");
}

TEST_F(TwoHalves, AStartElsewhereIsTaken) {
  core::Pose2 moved = endOfRun(*shared_folder / "first");
  moved.x += 0.05;
  build("icp", "first", {}, "icp_first");
  build("icp", "second", {*shared_folder / "icp_first", true, moved}, "moved");
  const auto manifest = resources::readManifest(*shared_folder / "moved/manifest.json");
  EXPECT_EQ(manifest.results.at("start.x_m"), files::formatNumber(moved.x));
}

TEST_F(TwoHalves, MethodsThatCannotSaySo) {
  for (const std::string method : {"naive", "rbpf"})
    EXPECT_THAT(errorOf([&] {
                  build(method, "second", {*shared_folder / "first", false, {}}, "x");
                }),
                HasSubstr("cannot go on in a map, expected type icp, particles or graph"));
  EXPECT_THAT(errorOf([&] {
                build("graph", "second", {*shared_folder / "nowhere", false, {}}, "x");
              }),
              HasSubstr("nowhere/manifest.json: no such file"));
  build("graph", "first", {}, "broken");
  files::writeFileAtomically(*shared_folder / "broken/map.simplemap", "not a map");
  EXPECT_THAT(errorOf([&] {
                build("graph", "second", {*shared_folder / "broken", false, {}}, "x");
              }),
              HasSubstr("broken/map.simplemap: is no MRPT simplemap"));
  EXPECT_FALSE(std::filesystem::exists(*shared_folder / "x"));
}

// Intel's stamps run back, so that the path through trajectory.tum, which is in the order of stamps, goes
// back and forth.
TEST_F(TwoHalves, LengthAndEndAreThoseOfTheLogsOrder) {
  auto run = results::loadRun(*shared_folder / "whole");
  const auto as_run = score::evaluate(run, {});
  std::swap(run.estimate[20].pose, run.estimate[90].pose);
  std::swap(run.estimate.front().pose, run.estimate.back().pose);
  const auto shuffled = score::evaluate(run, {});
  EXPECT_EQ(shuffled.path_length_m, as_run.path_length_m);
  EXPECT_EQ(shuffled.end_pose.x, as_run.end_pose.x);
  EXPECT_NEAR(as_run.end_pose.x, whole_end.x, 0.05);
  for (const char* key : {"path_length_m", "end.x_m"}) run.manifest.results.erase(key);
  EXPECT_GT(score::evaluate(run, {}).path_length_m, as_run.path_length_m + 1);
}

TEST_F(TwoHalves, ARunThatEndsLostHasItsFiguresAndANote) {
  auto run = results::loadRun(*shared_folder / "whole");
  run.manifest.results["lost"] = "lost at scan 90 (18.0 s)";
  const auto evaluation = score::evaluate(run, {});
  EXPECT_GT(evaluation.path_length_m, 1);
  EXPECT_THAT(score::agreementTable({evaluation}, score::Detail::kShort).notes[1],
              HasSubstr("graph failed: lost at scan 90 (18.0 s)"));
}

// `rasterslam run` ends with exit code 4 then; the files are all there.
TEST_F(TwoHalves, AComparisonShowsTheFiguresOfARunThatEndsLost) {
  const std::string program = *shared_folder / "lost.sh";
  files::writeFileAtomically(program,
                             "#!/bin/sh\n"
                             "cp -r '" +
                                 (*shared_folder / "whole") + "' \"$5\"\n" +
                                 R"(sed -i 's/"results": {/&"lost": "lost at scan 90",/' "$5/manifest.json")"
                                 "\n" +
                                 R"(echo '{"lost": "lost at scan 90"}')"
                                 "\nexit 4\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  score::CompareRequest request;
  request.log_path = *shared_folder / "whole.rawlog";
  request.methods_folder = resources::configsFolder() + "/methods";
  request.methods = {"graph"};
  request.output = *shared_folder / "compared";
  request.program = program;
  const auto comparison = score::compare(request, {}, core::silentProgress());
  EXPECT_EQ(comparison.failed, 1);
  EXPECT_EQ(comparison.evaluations[0].failure, "lost at scan 90");
  EXPECT_LT(comparison.evaluations[0].trajectory.position_m.rmse, 0.1);
}

}  // namespace
}  // namespace slam::run
