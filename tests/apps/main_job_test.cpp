#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "libslam/core/pose2.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Every file of a folder with its hash, but for those that hold times.
std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> hashes;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    const bool holds_times = name == "timing.csv" || name == "cost.csv" || name == "cost.json" ||
                             name.find("manifest.json") != std::string::npos;
    if (entry.is_regular_file() && !holds_times)
      hashes[fs::relative(entry.path(), folder).string()] = resources::fileSha256(entry.path().string());
  }
  return hashes;
}

TEST(MainJob, FromPlanToTableByHand) {
  const testing::TempFolder folder;
  const auto simulated = rasterslam("simulate flat -o run.rawlog --duration 40 --seed 2", folder.path());
  ASSERT_EQ(simulated.exit_code, 0) << simulated.err;
  EXPECT_THAT(simulated.out, HasSubstr("201 scans in 40.0 s"));
  for (const char* file :
       {"run.rawlog", "run.rawlog.GT.txt", "run.gt.tum", "run.operations.txt", "run.manifest.json"})
    EXPECT_TRUE(fs::exists(folder / file)) << file;

  const auto info = rasterslam("info run.rawlog --json", folder.path());
  ASSERT_EQ(info.exit_code, 0) << info.err;
  const auto facts = nlohmann::json::parse(info.out);
  EXPECT_EQ(facts["scans"], 201);
  EXPECT_EQ(facts["beams"], 541);
  EXPECT_NEAR(facts["fov_deg"].get<double>(), 270, 1e-4);  // MRPT keeps the aperture as a float

  const auto mapped = rasterslam("run icp run.rawlog -o out", folder.path());
  ASSERT_EQ(mapped.exit_code, 0) << mapped.err;
  for (const char* file : {"trajectory.tum", "map.yaml", "map.png", "map.gridmap.gz", "map.simplemap",
                           "map.3Dscene", "timing.csv", "manifest.json"}) {
    EXPECT_TRUE(fs::exists(folder / ("out/" + std::string(file)))) << file;
    EXPECT_THAT(mapped.out, file == std::string("manifest.json") ? HasSubstr("out/") : HasSubstr(file));
  }
  EXPECT_EQ(logs::readTum(folder / "out/trajectory.tum").size(), 201U);

  const auto scored = rasterslam("eval out --truth run.gt.tum --plan flat --json", folder.path());
  ASSERT_EQ(scored.exit_code, 0) << scored.err;
  const auto row = nlohmann::json::parse(scored.out)["scores"]["rows"][0];
  EXPECT_LT(row["ate_rmse_m"].get<double>(), 0.1);  // a flat of 12 m: ICP stays well within a cell or two
  EXPECT_GT(row["wall_f1"].get<double>(), 0.8);
  EXPECT_GT(row["free_iou"].get<double>(), 0.8);

  const auto again = rasterslam("simulate flat -o run.rawlog", folder.path());
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("run.rawlog: exists; give --overwrite to replace it"));
}

TEST(EvalGate, PassesItsOwnBaselineAndIsShutByWorse) {
  const testing::TempFolder folder;
  const auto at = [&](const std::string& arguments) { return rasterslam(arguments, folder.path()); };
  ASSERT_EQ(at("simulate flat -o run.rawlog --duration 10 -q").exit_code, 0);
  ASSERT_EQ(at("run naive_flow run.rawlog -o out -q").exit_code, 0);
  const std::string eval = "eval out --truth run.gt.tum --plan flat ";
  ASSERT_EQ(at(eval + "--write-gate gate.json").exit_code, 0);
  const auto again = at(eval + "--write-gate gate.json");
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("gate.json: holds rows of 'naive_flow'; give --overwrite"));
  EXPECT_EQ(at(eval + "--write-gate gate.json --overwrite").exit_code, 0);
  const auto same = at(eval + "--gate gate.json");
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("0 worse, 0 missing"));

  auto gate = nlohmann::json::parse(files::readTextFile(folder / "gate.json"));
  for (auto& row : gate["rows"])
    if (row["metric"] == "ate_rmse_m") row["value"] = 1e-9, row["absolute"] = 1e-6;
  files::writeFileAtomically(folder / "strict.json", gate.dump());
  const auto worse = at(eval + "--gate strict.json --json");
  EXPECT_EQ(worse.exit_code, 5) << worse.err;
  const auto rows = nlohmann::json::parse(worse.out)["gate"]["rows"];
  EXPECT_EQ(rows.size(), gate["rows"].size());
  for (const auto& row : rows) EXPECT_EQ(row["verdict"], row["metric"] == "ate_rmse_m" ? "WORSE" : "ok");

  // Without the plan its figures are missing: a gate does not open because nobody looked.
  const auto missing = at("eval out --truth run.gt.tum --gate gate.json");
  EXPECT_EQ(missing.exit_code, 5);
  EXPECT_THAT(missing.out, HasSubstr("MISSING"));
  files::writeFileAtomically(folder / "broken.json", "{");
  const auto broken = at(eval + "--gate broken.json");
  EXPECT_EQ(broken.exit_code, 3);
  EXPECT_THAT(broken.err, HasSubstr("broken.json: is not JSON"));
  EXPECT_EQ(at(eval + "--gate gate.json --write-gate other.json").exit_code, 2);
}

TEST(EvalGate, HoldsRelationsToo) {
  const testing::TempFolder folder;
  const auto at = [&](const std::string& arguments) { return rasterslam(arguments, folder.path()); };
  logs::writeTum({{1, {0, 0, 0}}, {2, {1, 0, 0}}}, folder / "path.tum");
  logs::writeTum({{1, {0, 0, 0}}, {2, {1.1, 0, 0}}}, folder / "worse.tum");
  files::writeFileAtomically(folder / "a.relations", "1 2 0.99 0 0 0 0 0\n");
  ASSERT_EQ(at("eval path.tum --relations a.relations --write-gate gate.json").exit_code, 0);
  EXPECT_EQ(at("eval path.tum --relations a.relations --gate gate.json").exit_code, 0);
  ASSERT_EQ(at("eval worse.tum --relations a.relations --gate gate.json").exit_code, 3);
  fs::rename(folder / "worse.tum", folder / "path.tum");
  const auto worse = at("eval path.tum --relations a.relations --gate gate.json");
  EXPECT_EQ(worse.exit_code, 5);
  EXPECT_THAT(worse.out, HasSubstr("translation_mean_m"));
}

TEST(MainJob, CovariancesAreWrittenAndJudgedWhereAMethodGivesThem) {
  const testing::TempFolder folder;
  const auto at = [&](const std::string& arguments) { return rasterslam(arguments, folder.path()); };
  ASSERT_EQ(at("simulate flat -o run.rawlog --duration 10 -q").exit_code, 0);
  for (const std::string method : {"naive_flow", "graph", "particles"}) {
    const bool says = method != "naive_flow";
    ASSERT_EQ(at("run " + method + " run.rawlog -o " + method + " -q").exit_code, 0);
    EXPECT_EQ(fs::exists(folder / (method + "/covariances.csv")), says) << method;
    const auto scored = at("eval " + method + " --truth run.gt.tum --json");
    ASSERT_EQ(scored.exit_code, 0) << scored.err;
    const auto row = nlohmann::json::parse(scored.out)["scores"]["rows"][0];
    EXPECT_EQ(row["anees"].is_number(), says) << method;
    EXPECT_EQ(row["anees_final"].is_number(), says) << method;
    EXPECT_EQ(fs::exists(folder / (method + "/covariances_final.csv")), says) << method;
    EXPECT_EQ(row["within_95_share"].is_number(), says) << method;
  }
  files::writeFileAtomically(folder / "graph/covariances.csv", "0,1,0,0,1,0,1\n");
  const auto cut = at("eval graph --truth run.gt.tum");
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_THAT(cut.err, HasSubstr("graph/covariances.csv: found 1 covariances, expected one for each of"));
}

TEST(MainJob, SameSeedSameBytesWithOneAndTwoThreads) {
  const testing::TempFolder folder;
  const std::string common = "compare flat --duration 20 --seed 3 -q --methods naive,icp,rbpf,rbpf_exact -o ";
  const auto one = rasterslam(common + "one --threads 1", folder.path());
  ASSERT_EQ(one.exit_code, 0) << one.err;
  ASSERT_EQ(rasterslam(common + "two --threads 2", folder.path()).exit_code, 0);
  const auto first = contents(folder / "one");
  EXPECT_GT(first.size(), 35U);
  EXPECT_EQ(first, contents(folder / "two"));
  ASSERT_EQ(
      rasterslam("compare flat --duration 20 --seed 4 -q --methods naive -o other", folder.path()).exit_code,
      0);
  EXPECT_NE(first.at("log/run.rawlog"), contents(folder / "other").at("log/run.rawlog"));
}

TEST(MainJob, AnInterruptedComparisonResumes) {
  const testing::TempFolder folder;
  // The program is stopped at its first progress report after the first method's folder has appeared. The
  // second waits.
  std::ofstream(folder / "waits.ini")
      << "[method]\ntype = external\ncommand = until ls {here} | grep -q go; do sleep 0.05; done && "
         R"(awk '{ printf "%s %s %s 0 0 0 %.9f %.9f\n", $1, $2, $3, sin($4 / 2), cos($4 / 2) }' {scans} > {output})"
         "\n";
  const auto stopped = testing::runCommand(
      "cd '" + folder.path() +
      "' && { '" RASTERSLAM_PROGRAM
      "' compare flat --duration 10 -q --methods naive_wheel,waits.ini -o out & pid=$!; "
      "while [ ! -d out/naive_wheel ] && kill -0 $pid; do :; done; kill -INT $pid; wait $pid; }");
  ASSERT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr("rasterslam: interrupted; go on with: rasterslam compare flat"));
  EXPECT_THAT(stopped.err, HasSubstr("--resume\n"));
  EXPECT_FALSE(fs::exists(folder / "out/waits"));
  EXPECT_THAT(testing::leftoversIn(folder / "out"), ::testing::IsEmpty());
  EXPECT_THAT(rasterslam("compare flat -o out", folder.path()).err, HasSubstr("--resume"));
  const auto before = fs::last_write_time(folder / "out/naive_wheel/trajectory.tum");
  std::ofstream(folder / "go") << "";
  const auto resumed = rasterslam(
      "compare flat --duration 10 -q --methods naive_wheel,waits.ini -o out --resume", folder.path());
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(fs::last_write_time(folder / "out/naive_wheel/trajectory.tum"), before);
  ASSERT_EQ(
      rasterslam("compare flat --duration 10 -q --methods naive_wheel,waits.ini -o whole", folder.path())
          .exit_code,
      0);
  EXPECT_EQ(contents(folder / "out"), contents(folder / "whole"));
}

TEST(MainJob, ARealLogWithoutTruthSaysWhatCanBeSaid) {
  const std::string log = "/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";
  if (!fs::exists(log)) GTEST_SKIP() << "Debian's package mrpt-common is not installed";
  const testing::TempFolder folder;
  const auto result =
      rasterslam("compare '" + log + "' --methods naive_wheel,icp -o out -q --json", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto scores = nlohmann::json::parse(result.out)["scores"];
  EXPECT_THAT(scores["caption"].get<std::string>(), HasSubstr("No truth is known"));
  const auto icp = scores["rows"][1];
  // Where MRPT's own icp-slam ends with its two shipped configurations, within what those differ by several
  // times.
  EXPECT_NEAR(icp["end_x_m"].get<double>(), 4.27, 0.4);
  EXPECT_NEAR(icp["end_y_m"].get<double>(), -18.46, 0.4);
  EXPECT_GT(icp["agreement_m"].get<double>(), 0.0);
}

TEST(MainJob, RealPlansGiveALogAndATable) {
  const std::string data = testing::realDataFolder(RASTERSLAM_SOURCE_DIR);
  if (data.empty()) GTEST_SKIP() << "the folder of real data is not there (RASTERSLAM_REAL_DATA)";
  const testing::TempFolder folder;
  for (const std::string plan : {"willow/willow-full.yaml", "turtlebot3/map.yaml", "nav2/depot.yaml"}) {
    const auto result =
        rasterslam("compare '" + data + "/worlds/" + plan +
                       "' --duration 30 -q --json --overwrite --methods naive_wheel,icp -o out",
                   folder.path());
    ASSERT_EQ(result.exit_code, 0) << plan << result.err;
    const auto icp = nlohmann::json::parse(result.out)["scores"]["rows"][1];
    EXPECT_LT(icp["ate_rmse_m"].get<double>(), 0.25)
        << plan;  // half a minute of driving: a loose bound, a lost map is metres
    EXPECT_GT(icp["wall_f1"].get<double>(), 0.5) << plan;
  }
}

TEST(MainJob, PrintsItsConfigurationWithOrigins) {
  const testing::TempFolder folder;
  const auto result = rasterslam(
      "simulate flat --lidar lms291 --set lidar.sigma_m=0.02 --strategy longest_ray --print-config",
      folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, ::testing::ContainsRegex("sigma_m = 0.02 +# --set"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("name = longest_ray +# --strategy"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("beams = 361 +# .*lms291.ini:[0-9]+"));
  EXPECT_THAT(result.out, ::testing::ContainsRegex("side_m = 0.4 +# built-in"));
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(MainJob, ListsEverythingAsTextAndJson) {
  for (const std::string what : {"methods", "strategies", "navigators", "worlds", "lidars", "metrics"}) {
    const auto text = rasterslam("list " + what), json = rasterslam("list " + what + " --json");
    ASSERT_EQ(text.exit_code, 0) << text.err;
    const auto entries = nlohmann::json::parse(json.out);
    EXPECT_GE(entries.size(), 2U) << what;
    for (const auto& entry : entries) {
      EXPECT_NE(entry["meaning"], "") << what << " " << entry["name"];
      EXPECT_THAT(text.out, HasSubstr(entry["name"].get<std::string>()));
    }
  }
}

}  // namespace
}  // namespace slam::apps
