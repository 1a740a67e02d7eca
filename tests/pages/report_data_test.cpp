#include "libslam/pages/report_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::pages {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

report::ReportPage gather(const std::string& folder) {
  return gatherReport(folder, core::silentProgress());
}

/// Two methods on ten seconds in the flat, once for all tests.
class ReportData : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "10", "test");
    ini.set("lidar", "beams", "91", "test");
    score::CompareRequest request;
    request.plan_path = resources::resolvePlan("flat");
    request.record = record::readRecordConfig(ini);
    request.methods = {"naive_wheel", "graph"};
    request.methods_folder = resources::configsFolder() + "/methods";
    request.output = *shared_folder / "out";
    score::compare(request, {}, core::silentProgress());
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  /// A copy that a test may spoil.
  std::string copy() {
    std::string path = own_ / "out";
    fs::copy(*shared_folder / "out", path, fs::copy_options::recursive);
    return path;
  }
  static std::string output() { return *shared_folder / "out"; }

  static testing::TempFolder* shared_folder;
  testing::TempFolder own_;
};
testing::TempFolder* ReportData::shared_folder = nullptr;

TEST_F(ReportData, AComparisonHasTheBestFirstTruthPlanAndScans) {
  const auto page = gather(output());
  ASSERT_EQ(page.runs.size(), 2U);
  EXPECT_EQ(page.runs[0].method, "graph");
  EXPECT_TRUE(page.replays[0].plan.has_value());
  EXPECT_EQ(page.replays[0].truth.size(), page.runs[0].path.size());
  EXPECT_EQ(page.runs[0].error_m.size(), page.runs[0].path.size());
  EXPECT_EQ(page.replays[0].scan_count, page.replays[0].scans.size());
  EXPECT_EQ(page.runs[0].scan_ms.size(), page.runs[0].path.size());
  EXPECT_THAT(page.missing, IsEmpty());
  EXPECT_THAT(page.verdict.front(), HasSubstr("graph came nearest to the truth"));
}

TEST_F(ReportData, TheSameFolderGivesTheSameBytes) {
  EXPECT_EQ(report::toHtml(gather(output())), report::toHtml(gather(output())));
}

TEST_F(ReportData, OneRunOfItIsAPageToo) {
  const auto page = gather(output() + "/graph");
  ASSERT_EQ(page.runs.size(), 1U);
  EXPECT_TRUE(page.replays[0].plan.has_value());
  EXPECT_FALSE(page.replays[0].scans.empty());
}

TEST_F(ReportData, ARunThatWentOnInAMapFindsItsLogNotTheMap) {
  const auto folder = copy();
  const auto path = folder + "/graph/manifest.json";
  auto manifest = resources::readManifest(path);
  manifest.inputs = {{folder + "/graph/map.simplemap", "0"}, {folder + "/log/run.rawlog", "0"}};
  resources::writeManifest(manifest, path);
  EXPECT_FALSE(gather(folder + "/graph").replays[0].scans.empty());
}

TEST_F(ReportData, AMethodThatFailedKeepsItsRowAndReason) {
  const auto folder = copy();
  fs::remove_all(folder + "/graph");
  auto scores = files::readTextFile(folder + "/scores.json");
  const std::string notes = "\"notes\": [";
  const auto at = scores.find(notes);
  ASSERT_NE(at, std::string::npos);
  scores.insert(at + notes.size(), "\"graph failed: killed by signal 9\",");
  files::writeFileAtomically(folder + "/scores.json", scores);
  const auto page = gather(folder);
  ASSERT_EQ(page.runs.size(), 2U);
  EXPECT_EQ(page.runs[1].failure, "killed by signal 9");
  EXPECT_EQ(std::get<std::string>(page.tables[0].rows[1][0]), "graph");
  EXPECT_THAT(report::toHtml(page), HasSubstr("Failed: killed by signal 9"));
}

TEST_F(ReportData, AnUnfinishedComparisonShowsWhatIsThereAndSaysSo) {
  const auto folder = copy();
  fs::remove(folder + "/scores.json");
  fs::remove_all(folder + "/naive_wheel");
  const auto page = gather(folder);
  EXPECT_EQ(page.runs.size(), 1U);
  ASSERT_EQ(page.missing.size(), 1U);
  EXPECT_THAT(page.missing[0], HasSubstr("not finished"));
}

TEST_F(ReportData, WithoutItsLogThereAreNoScansAndThePageSaysSo) {
  const auto folder = copy();
  fs::remove_all(folder + "/log");
  fs::create_directory(folder + "/hidden");
  for (const char* method : {"graph", "naive_wheel"}) {
    auto manifest = resources::readManifest(folder + "/" + method + "/manifest.json");
    manifest.results["log"] = "/nowhere/run.rawlog";
    resources::writeManifest(manifest, folder + "/" + method + "/manifest.json");
  }
  const auto page = gather(folder);
  EXPECT_TRUE(page.replays[0].scans.empty());
  ASSERT_EQ(page.missing.size(), 1U);
  EXPECT_THAT(page.missing[0], HasSubstr("/nowhere/run.rawlog is not there any more"));
  EXPECT_THAT(page.verdict.front(), HasSubstr("No truth is known"));
  EXPECT_THAT(report::toHtml(page), HasSubstr("id=\"replay-data\""));
}

TEST_F(ReportData, AFolderThatIsNoResultIsRefused) {
  EXPECT_THAT(errorOf([&] { gather(own_ / "nothing"); }), HasSubstr("is not a folder"));
  EXPECT_THAT(errorOf([&] { gather(own_.path()); }), HasSubstr("holds no manifest.json"));
  resources::writeManifest({}, own_ / "manifest.json");
  EXPECT_THAT(errorOf([&] { gather(own_.path()); }), HasSubstr("holds no run"));
}

TEST_F(ReportData, ADamagedTableIsNamed) {
  const auto folder = copy();
  files::writeFileAtomically(folder + "/scores.json", "[1, 2");
  EXPECT_THAT(errorOf([&] { gather(folder); }), HasSubstr("scores.json: is not a table"));
  files::writeFileAtomically(folder + "/scores.json", R"({"columns": [], "rows": [{"x": 1}]})");
  EXPECT_THAT(errorOf([&] { gather(folder); }), HasSubstr("a row names no method"));
}

TEST_F(ReportData, DamagedTimesAreNamedByLine) {
  const auto folder = copy();
  files::writeFileAtomically(folder + "/graph/timing.csv", "scan,time_s,cpu_ms\n0,0,x\n");
  EXPECT_THAT(errorOf([&] { gather(folder); }), HasSubstr("timing.csv:2: found '0,0,x'"));
}

TEST_F(ReportData, SavedMapsNameTheirOwnPicture) {
  const auto page = gather(output());
  const auto yaml = std::find_if(page.downloads.begin(), page.downloads.end(),
                                 [](const auto& file) { return file.name == "graph_map.yaml"; });
  ASSERT_NE(yaml, page.downloads.end());
  EXPECT_THAT(yaml->bytes, HasSubstr("image: graph_map.png\n"));
}

}  // namespace
}  // namespace slam::pages
