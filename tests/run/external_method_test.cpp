#include "libslam/run/external_method.h"
#include "libslam/run/external_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/metrics/trajectory_error.h"
#include "libslam/record/record.h"
#include "libslam/resources/file_hash.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/manifest.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/score/compare.h"
#include "libslam/sweep/sweep_plan.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"

namespace slam::run {
namespace {
namespace fs = std::filesystem;
using slam::testing::errorOf;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Scans a second apart, a metre of odometry between them.
const std::vector<ScanPlace> kScans = {
    {100, {0, 0, 0}}, {101, {1, 0, 0}}, {102, {2, 0, 0}}, {103, {3, 0, 0}}};

TEST(CheckPath, TakesEveryScanByItsStamp) {
  const auto checked = checkPath(
      "# time x y z qx qy qz qw\n100 5 5 0 0 0 0 1\n101.00004 6 5 0 0 0 0 1\n"
      "102 7 5 0 0 0 0 1\n\n103 7 6 0 0 0 0.70710678 0.70710678\n",
      "path.tum", kScans);
  EXPECT_THAT(checked.violations, IsEmpty());
  ASSERT_EQ(checked.path.size(), 4U);
  EXPECT_EQ(checked.filled_poses, 0);
  // From the first scan's pose.
  EXPECT_NEAR(checked.path[0].pose.x, 0, 1e-12);
  EXPECT_NEAR(checked.path[3].pose.x, 2, 1e-12);
  EXPECT_NEAR(checked.path[3].pose.y, 1, 1e-12);
  EXPECT_NEAR(checked.path[3].pose.phi, core::kPi / 2, 1e-7);
  EXPECT_EQ(checked.path[1].time_s, 101);
}

TEST(CheckPath, RefusesPosesThatNoRobotReaches) {
  const auto checked =
      checkPath("100 0 0 0 0 0 0 1\n101 1e300 0 0 0 0 0 1\n102 0 -1e7 0 0 0 0 1\n", "p", kScans);
  EXPECT_THAT(checked.violations,
              ElementsAre("p:2: found '101 1e300 0 0 0 0 0 1', expected x and y within 1000 km",
                          "p:3: found '102 0 -1e7 0 0 0 0 1', expected x and y within 1000 km"));
}

TEST(CheckPath, SaysEveryViolationWithItsLine) {
  const auto checked = checkPath(
      "100 0 0 0 0 0 0 1\n101 nan 0 0 0 0 0 1\n101 1 0 0 0 0 1\n101.5 1 0 0 0 0 0 1\n"
      "102 1 0 0 0 0 0 0.5\n103 1 0 0 0 0 0 1\n101 1 0 0 0 0 0 1\n103 1 0 0 0 0 0 1\n"
      "102 x 0 0 0 0 0 1\n",
      "p", kScans);
  EXPECT_THAT(checked.path, IsEmpty());
  EXPECT_THAT(
      checked.violations,
      ElementsAre("p:2: found '101 nan 0 0 0 0 0 1', expected finite numbers",
                  "p:3: found '101 1 0 0 0 0 1', expected 8 numbers: time x y z qx qy qz qw",
                  "p:4: found the stamp 101.500000, which is no scan's of the log; the nearest is 102.000000",
                  "p:5: found a quaternion of length 0.5, expected 1",
                  "p:7: found the stamp 101.000000 behind 103.000000, expected the order of stamps or of the "
                  "log's scans",
                  "p:8: found a second pose for the scan with the stamp 103.000000, expected one",
                  "p:9: found '102 x 0 0 0 0 0 1', expected 8 numbers: time x y z qx qy qz qw"));
}

TEST(CheckPath, NamesTwentyViolationsAndCountsTheRest) {
  std::string text;
  for (int i = 0; i < 25; ++i) text += "1 2 3\n";
  const auto checked = checkPath(text, "p", kScans);
  ASSERT_EQ(checked.violations.size(), 21U);
  EXPECT_EQ(checked.violations.back(), "p: and 5 more lines that break the contract");
  EXPECT_THAT(checkPath("# nothing\n", "p", kScans).violations,
              ElementsAre("p: holds 0 poses, expected at least 1"));
}

TEST(CheckPath, StampsMayRunBackWhereTheLogsDo) {
  const std::vector<ScanPlace> scans = {{100, {}}, {102, {}}, {101, {}}, {103, {}}};
  const auto in_log_order =
      checkPath("100 0 0 0 0 0 0 1\n102 1 0 0 0 0 0 1\n101 2 0 0 0 0 0 1\n103 3 0 0 0 0 0 1\n", "p", scans);
  const auto in_stamp_order =
      checkPath("100 0 0 0 0 0 0 1\n101 2 0 0 0 0 0 1\n102 1 0 0 0 0 0 1\n103 3 0 0 0 0 0 1\n", "p", scans);
  for (const auto* checked : {&in_log_order, &in_stamp_order}) {
    ASSERT_THAT(checked->violations, IsEmpty());
    for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(checked->path[i].pose.x, static_cast<double>(i), 1e-12);
  }
}

TEST(CheckPath, ScansOfOneStampGetTheirPosesInTurn) {
  const std::vector<ScanPlace> scans = {{100, {}}, {100, {}}};
  const auto checked = checkPath("100 0 0 0 0 0 0 1\n100 1 0 0 0 0 0 1\n", "p", scans);
  ASSERT_THAT(checked.violations, IsEmpty());
  EXPECT_NEAR(checked.path[1].pose.x, 1, 1e-12);
}

TEST(CheckPath, FillsWhatIsLeftOutWithTheOdometry) {
  // The program says 4 m where the odometry says 2: what is missing is shared out.
  const auto between = checkPath("100 0 0 0 0 0 0 1\n102 4 0 0 0 0 0 1\n", "p", kScans);
  ASSERT_THAT(between.violations, IsEmpty());
  EXPECT_EQ(between.filled_poses, 2);
  EXPECT_NEAR(between.path[1].pose.x, 2, 1e-12);
  EXPECT_NEAR(between.path[3].pose.x, 5, 1e-12);
  const auto before = checkPath("102 0 0 0 0 0 0 1\n", "p", kScans);
  EXPECT_EQ(before.filled_poses, 3);
  EXPECT_NEAR(before.path[2].pose.x, 2, 1e-12);
}

class External : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    shared_folder = new testing::TempFolder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "8", "test");
    ini.set("lidar", "beams", "181", "test");
    record::record(world::loadPlan(resources::resolvePlan("flat")), record::readRecordConfig(ini), 1, log(),
                   {}, core::silentProgress());
  }
  static void TearDownTestSuite() {
    delete shared_folder;
    shared_folder = nullptr;
  }
  static std::string log() { return *shared_folder / "run.rawlog"; }

  /// An .ini beside which nothing else lies.
  std::string method(const std::string& command, const std::string& more = "") {
    std::string path = here_ / "mine.ini";
    files::writeFileAtomically(path, "[method]\ntype = external\ncommand = " + command + "\n" + more);
    return path;
  }
  ExternalRun run(const std::string& command, const std::string& more = "") {
    const auto external = readExternalMethod(resources::readConfigFile(method(command, more)));
    return runExternalMethod(external, log(), 7, here_ / "work", core::silentProgress());
  }
  std::string errorOfConfig(const std::string& command, const std::string& more = "") {
    const auto path = method(command, more);
    return errorOf([&] { readExternalMethod(resources::readConfigFile(path)); });
  }

  testing::TempFolder here_;
  static testing::TempFolder* shared_folder;
};
testing::TempFolder* External::shared_folder = nullptr;

/// A program that believes the wheels.
const std::string kWheels =
    R"(awk '{ print $1, $2, $3, 0, 0, 0, sin($4 / 2), cos($4 / 2) }' {scans} > {output})";

TEST_F(External, AProgramIsAMethodWithARunFolderOfItsOwn) {
  const auto config = resources::readConfigFile(method(kWheels, "[mapping]\nresolution_m = 0.1\n"));
  const auto run = buildMap(log(), config, "mine", 1, here_ / "out", false, {}, core::silentProgress());
  const auto ours =
      buildMap(log(), mapping::loadMethodConfig(resources::configsFolder() + "/methods", "naive_wheel"),
               "naive_wheel", 1, here_ / "wheels", false, {}, core::silentProgress());
  ASSERT_EQ(run.estimate.size(), ours.estimate.size());
  EXPECT_NEAR(run.end.x, ours.end.x, 1e-6);
  EXPECT_NEAR(run.end.phi, ours.end.phi, 1e-6);
  EXPECT_GT(run.cost.mean_ms_per_scan, 0);
  EXPECT_GT(run.cost.peak_memory_mb, 0);
  EXPECT_TRUE(fs::exists(here_ / "out/printed.txt"));
  EXPECT_FALSE(fs::exists(here_ / "out/timing.csv"));
  EXPECT_FALSE(fs::exists(here_ / "out/work"));
  const auto folder = results::loadRun(here_ / "out");
  EXPECT_EQ(folder.map.resolution_m, 0.1);
  EXPECT_EQ(folder.manifest.config.at("method.type"), "external");
  EXPECT_TRUE(std::isnan(folder.cost.p99_ms_per_scan));
}

TEST_F(External, IsARowOfAComparison) {
  score::CompareRequest request;
  request.log_path = log();
  request.methods_folder = resources::configsFolder() + "/methods";
  request.methods = {method(kWheels), "naive_wheel"};
  request.output = here_ / "out";
  const auto comparison = score::compare(request, {}, core::silentProgress());
  ASSERT_EQ(comparison.evaluations.size(), 2U);
  EXPECT_NEAR(comparison.evaluations[0].trajectory.position_m.rmse,
              comparison.evaluations[1].trajectory.position_m.rmse, 1e-5);
  request.resume = true;
  EXPECT_EQ(score::compare(request, {}, core::silentProgress()).reused, 2);
}

TEST_F(External, ItsFilesAreAPartOfIt) {
  const auto config = [&](const std::string& command) { return resources::readConfigFile(method(command)); };
  const std::string script = here_ / "my slam.sh";
  files::writeFileAtomically(script, kWheels);
  const auto shell = programFiles(config("sh {output}"));
  ASSERT_EQ(shell.size(), 1U);
  EXPECT_EQ(fs::path(shell.begin()->first).filename(), "sh");
  const auto [sh, hash] = *shell.begin();
  using Files = std::map<std::string, std::string>;
  EXPECT_EQ(programFiles(config("A=1 sh {here}/'my slam.sh' sh {log} {output} no/such")),
            (Files{{sh, hash}, {script, resources::fileSha256(script)}}));
  EXPECT_EQ(
      programFiles(config("no_such_program {output} && sh --rcfile=" + resources::shellQuoted({script}))),
      (Files{{sh, hash}, {script, resources::fileSha256(script)}}));
  EXPECT_EQ(programFiles(config("\"" + sh + "\" {here} sh >{output} 2>> {here}/'my slam.sh'")),
            (Files{{sh, hash}}));
}

TEST_F(External, ChangedFilesAreAnotherMethod) {
  const std::string script = here_ / "slam.sh";
  const auto write = [&](const std::string& end) {
    files::writeFileAtomically(script,
                               "awk '{ print $1, $2, $3, 0, 0, 0, sin($4 / 2), cos($4 / 2) }' $1 > $2" + end);
  };
  write("");
  score::CompareRequest request;
  request.log_path = log();
  request.methods_folder = resources::configsFolder() + "/methods";
  request.methods = {method("sh {here}/slam.sh {scans} {output}")};
  request.output = here_ / "out";
  files::writeFileAtomically(here_ / "suite.ini", "[suite]\nworlds = flat\nmethods = mine.ini\nseeds = 1\n");
  score::compare(request, {}, core::silentProgress());
  const auto id = sweep::planSweep(here_ / "suite.ini").plan.runs.at(0).id;
  request.resume = true;
  EXPECT_EQ(score::compare(request, {}, core::silentProgress()).reused, 1);
  EXPECT_EQ(sweep::planSweep(here_ / "suite.ini").plan.runs.at(0).id, id);
  write("\n# mended\n");
  EXPECT_EQ(score::compare(request, {}, core::silentProgress()).reused, 0);
  EXPECT_NE(sweep::planSweep(here_ / "suite.ini").plan.runs.at(0).id, id);
}

TEST_F(External, SeesNoTruthAndWorksInAnEmptyFolder) {
  std::string text, readings;
  for (int i = 0; i < 180; ++i) readings += "2 ";
  for (const std::string x : {"0", "0.1", "0.2"}) {
    const std::string tail = x + " 0 0 " + x + " 0 0 100" + x.substr(1) + " host 0\n";
    text += "TRUEPOS " + tail + "FLASER 180 " + readings + tail;
  }
  files::writeFileAtomically(here_ / "robot.clf", text);
  for (const std::string form : {"carmen", "observation"}) {
    const auto ini = method(
        "find {workdir} {workdir}/.. -type f && test -z \"$(ls)\" && ! grep -q TRUE {log} && " + kWheels,
        "log = " + form + "\n");
    const auto result = runExternalMethod(readExternalMethod(resources::readConfigFile(ini)),
                                          here_ / "robot.clf", 1, here_ / "work", core::silentProgress());
    EXPECT_THAT(result.violations, IsEmpty()) << result.printed;
    EXPECT_THAT(result.printed, HasSubstr(form == "carmen" ? "log.clf" : "log.rawlog"));
    // The log and the scans.
    EXPECT_EQ(std::count(result.printed.begin(), result.printed.end(), '\n'), 2) << result.printed;
    EXPECT_FALSE(fs::exists(here_ / "work"));
  }
}

TEST_F(External, GetsItsSeedAndTheFolderOfItsIni) {
  const auto result = run("echo seed {seed} in {here} '{ print }' && " + kWheels);
  EXPECT_THAT(result.violations, IsEmpty());
  EXPECT_THAT(result.printed, HasSubstr("seed 7 in " + here_.path() + " { print }"));
}

TEST_F(External, OfEndlessOutputTheBeginningAndTheEndAreKept) {
  const auto result = run("echo begin; yes | head -c 3000000; echo the end; " + kWheels);
  EXPECT_THAT(result.violations, IsEmpty());
  EXPECT_LT(result.printed.size(), 600000U);
  EXPECT_THAT(result.printed,
              AllOf(StartsWith("begin\n"), HasSubstr("bytes left out]\n"), HasSubstr("the end\n")));
}

TEST_F(External, WhatItOwesIsCheckedOneByOne) {
  EXPECT_THAT(run("echo no map today; exit 3 {output}").violations,
              ElementsAre("the program ended with exit code 3, expected 0; it last printed: no map today",
                          HasSubstr("did not write it")));
  EXPECT_THAT(run("true {output}").violations, ElementsAre(HasSubstr("did not write it")));
  EXPECT_THAT(run("kill -SEGV $$ {output}").violations[0], HasSubstr("killed by signal 11"));
  EXPECT_THAT(run(kWheels + " && echo 5 5 >> {output}").violations,
              ElementsAre(HasSubstr("expected 8 numbers")));
}

TEST_F(External, ItsLimitsAreKept) {
  EXPECT_THAT(run("while :; do :; done > {output}", "time_limit_s = 0.2\n").violations,
              ElementsAre("the program was stopped: it ran for more than 0.2 s"));
  EXPECT_THAT(run("awk 'BEGIN { while (1) a[i++] = i }' > {output}", "memory_limit_mb = 60\n").violations,
              ElementsAre(HasSubstr("more than 60 MB")));
}

TEST_F(External, ItsFilesAreNotReadBeyondWhatAPathCanTake) {
  EXPECT_THAT(run("yes | head -c 2000000 > {output}").violations,
              ElementsAre(HasSubstr("{output}: found 2000000 bytes, expected at most ")));
}

TEST_F(External, AViolationIsAMethodThatFailedAndLeavesNothing) {
  const auto config = resources::readConfigFile(method("exit 9 {output}"));
  try {
    buildMap(log(), config, "mine", 1, here_ / "out", false, {}, core::silentProgress());
    FAIL() << "no error";
  } catch (const core::MethodError& error) {
    EXPECT_THAT(error.what(), HasSubstr("method mine: the program ended with exit code 9"));
    EXPECT_THAT(error.what(), HasSubstr("(and 1 more: rasterslam plugin check)"));
  }
  EXPECT_FALSE(fs::exists(here_ / "out"));
  EXPECT_THAT(testing::leftoversIn(here_.path()), ::testing::IsEmpty());
}

TEST_F(External, AMisspeltConfigurationIsOneClearLine) {
  EXPECT_THAT(errorOfConfig("x {ouput}"),
              HasSubstr("mine.ini:3: section [method], key 'command': found '{ouput}'"));
  EXPECT_THAT(errorOfConfig("x {log}"), HasSubstr("found no {output}"));
  EXPECT_THAT(errorOfConfig(kWheels, "log = bag\n"), HasSubstr("key 'log': found 'bag'"));
  EXPECT_THAT(errorOfConfig(kWheels, "[graph]\n a = 1\n"), HasSubstr("graph"));
  files::writeFileAtomically(here_ / "none.ini", "[method]\ntype = external\n");
  EXPECT_THAT(errorOf([&] { readExternalMethod(resources::readConfigFile(here_ / "none.ini")); }),
              HasSubstr("none.ini:2: section [method]: key 'command' is missing"));
}

TEST_F(External, EveryShippedOneIsSound) {
  const std::string folder = resources::configsFolder() + "/plugins";
  const auto names = resources::namesInFolder(folder, ".ini");
  EXPECT_GE(names.size(), 3U);
  for (const auto& name : names)
    EXPECT_EQ(readExternalMethod(resources::readConfigFile(folder + "/" + name + ".ini")).folder, folder);
}

/// MRPT's programs as they are shipped, by name; skipped where they are not installed.
class Shipped : public External {
 protected:
  MapRun build(const std::string& config, const std::string& name) {
    return buildMap(log(), resources::readConfigFile(config), name, 1, here_ / name, false, {},
                    core::silentProgress());
  }
  static std::string plugin(const std::string& name) {
    return resources::configsFolder() + "/plugins/" + name + ".ini";
  }
  static double error(const MapRun& run) {
    return metrics::trajectoryError(logs::readTum(*shared_folder / "run.gt.tum"), run.estimate)
        .position_m.rmse;
  }
};

TEST_F(Shipped, IcpSlamGivesThePathOfOurIcp) {
  if (!testing::programExists("icp-slam"))
    GTEST_SKIP() << "icp-slam (Debian package mrpt-apps) is not installed";
  const auto theirs = build(plugin("icp-slam"), "theirs");
  const auto ours = build(resources::configsFolder() + "/methods/icp.ini", "ours");
  ASSERT_EQ(theirs.estimate.size(), ours.estimate.size());
  EXPECT_EQ(theirs.filled_poses, 0);
  // The program writes 4 decimals; the log's odometry is in single precision.
  for (size_t i = 0; i < ours.estimate.size(); ++i)
    EXPECT_LT(core::distance(theirs.estimate[i].pose, ours.estimate[i].pose), 2e-3) << i;
}

TEST_F(Shipped, RbpfSlamKeepsTheContract) {
  if (!testing::programExists("rbpf-slam"))
    GTEST_SKIP() << "rbpf-slam (Debian package mrpt-apps) is not installed";
  const auto run = build(plugin("rbpf-slam"), "rbpf");
  EXPECT_EQ(run.filled_poses, 0);
  EXPECT_LT(error(run), 0.3);
}

TEST_F(Shipped, GraphslamEngineKeepsTheContract) {
  if (!testing::programExists("graphslam-engine"))
    GTEST_SKIP() << "graphslam-engine (Debian package mrpt-apps) is not installed";
  const auto run = build(plugin("graphslam-engine"), "graphslam");
  EXPECT_GT(run.filled_poses, 0);
  EXPECT_LT(run.filled_poses, static_cast<int>(run.estimate.size()));
  EXPECT_LT(error(run), 0.3);
}

}  // namespace
}  // namespace slam::run
