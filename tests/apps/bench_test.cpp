#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <future>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "libslam/files/files.h"
#include "libslam/process/worker.h"
#include "libslam/sweep/sweep.h"
#include "tests/apps/bench_fixture.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

TEST_F(Bench, OneJobTwoJobsAndTwoShardsMergedGiveTheSameBytes) {
  const auto one = bench("tiny.ini -o one");
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("naive_wheel"));
  ASSERT_EQ(bench("tiny.ini -o two -q -j 2").exit_code, 0);
  ASSERT_EQ(bench("exec tiny.ini -o part1 -q --shard 1/2").exit_code, 0);
  const auto half = bench("merge part1");
  EXPECT_EQ(half.exit_code, 6);
  EXPECT_EQ(std::count(half.err.begin(), half.err.end(), '\n'), 3) << half.err;  // a log and its runs
  EXPECT_THAT(half.out, HasSubstr("Incomplete: 2 of 4 runs are missing."));
  ASSERT_EQ(bench("exec tiny.ini -o part2 -q --shard 2/2").exit_code, 0);
  ASSERT_EQ(bench("merge part1 part2 -o merged").exit_code, 0);
  const auto whole = contents(folder_ / "one");
  EXPECT_EQ(cellsOf(folder_ / "one", "run").size(), 4U);
  EXPECT_EQ(cellsOf(folder_ / "one", "log").size(), 2U);
  EXPECT_EQ(whole, contents(folder_ / "two"));
  EXPECT_EQ(whole, contents(folder_ / "merged"));
  EXPECT_FALSE(fs::exists(folder_ / "one/partial"));
}

TEST_F(Bench, EveryRowNamesItsFolderAndALineThatMakesItAgain) {
  ASSERT_EQ(bench("tiny.ini -o out -q").exit_code, 0);
  const auto row = resultsOf(folder_ / "out")[3];
  const std::string cell = row["folder"], line = row["reproduce"];
  ASSERT_EQ(line.rfind("rasterslam bench ", 0), 0U);
  const auto again = rasterslam(line.substr(std::string("rasterslam ").size()), folder_ / "out");
  ASSERT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(cellsOf(folder_ / "out/again", "run").size(), 1U);
  EXPECT_EQ(files::readTextFile(folder_ / ("out/" + cell + "/result.json")),
            files::readTextFile(folder_ / ("out/again/" + cell + "/result.json")));
}

TEST_F(Bench, ResumeDoesOnlyWhatIsMissingOrDamaged) {
  ASSERT_EQ(bench("tiny.ini -o out -q").exit_code, 0);
  const auto whole = contents(folder_ / "out");
  EXPECT_THAT(bench("tiny.ini -o out").err, HasSubstr("--resume"));
  const auto runs = cellsOf(folder_ / "out", "run"), logs = cellsOf(folder_ / "out", "log");
  fs::remove(runs[0] + "/result.json");  // a copy that was cut short
  write(runs[1] + "/run/trajectory.tum", "1 2 3");
  const std::string result = files::readTextFile(runs[2] + "/result.json");
  write(runs[2] + "/result.json", result.substr(0, result.size() / 2));
  fs::remove_all(logs[0]);
  write(folder_ / "out/index.sqlite", "not a database");
  const auto merged = bench("merge out");
  EXPECT_EQ(merged.exit_code, 6);
  EXPECT_THAT(merged.err, HasSubstr("trajectory.tum: has 5 bytes, expected"));
  EXPECT_THAT(merged.err, HasSubstr("result.json: is cut short"));
  const auto kept = fs::last_write_time(runs[3] + "/result.json");
  const auto resumed = bench("tiny.ini -o out --resume");
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(timesIn(resumed.err, "done again: "), 3U) << resumed.err;
  EXPECT_EQ(fs::last_write_time(runs[3] + "/result.json"), kept);
  EXPECT_EQ(whole, contents(folder_ / "out"));
}

// As on a disk that was full: what has not come to a plan is gone on with, what is somebody else's is not.
TEST_F(Bench, ResumeGoesOnWhereNotEvenThePlanWasWritten) {
  fs::create_directories(folder_ / "out/cells");
  write(folder_ / "out/suite.ini", "half of");
  const auto resumed = bench("tiny.ini -o out -q --resume");
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resultsOf(folder_ / "out").size(), 4U);

  fs::create_directories(folder_ / "other/cells");
  write(folder_ / "other/thesis.txt", "years");
  EXPECT_EQ(bench("tiny.ini -o other -q --resume").exit_code, 3);
  EXPECT_EQ(files::readTextFile(folder_ / "other/thesis.txt"), "years");
}

TEST_F(Bench, ACopyWithOtherBytesOfTheSameSizeShowsWhenAsked) {
  ASSERT_EQ(bench("tiny.ini -o out -q").exit_code, 0);
  const auto run = cellsOf(folder_ / "out", "run")[0];
  std::string path = files::readTextFile(run + "/run/trajectory.tum");
  path[path.size() / 2] = path[path.size() / 2] == '1' ? '2' : '1';
  write(run + "/run/trajectory.tum", path);
  EXPECT_EQ(bench("merge out").exit_code, 0);
  const auto checked = bench("merge out --check");
  EXPECT_EQ(checked.exit_code, 6);
  EXPECT_THAT(checked.err, HasSubstr("is not the file that the result was made with"));
}

TEST_F(Bench, ACellThatTwoPartsHaveIsFineWhenEqualAndAnErrorOtherwise) {
  ASSERT_EQ(bench("exec tiny.ini -o part -q").exit_code, 0);
  fs::copy(folder_ / "part", folder_ / "twin", fs::copy_options::recursive);
  EXPECT_EQ(bench("merge part twin -o whole").exit_code, 0);
  const std::string cell = fs::path(cellsOf(folder_ / "twin", "run")[0]).filename().string();
  const std::string path = folder_ / ("twin/cells/" + cell + "/result.json");
  write(path, replaced(files::readTextFile(path), "\"message\": \"\"", "\"message\": \"x\""));
  const auto merged = bench("merge part twin -o other");
  EXPECT_EQ(merged.exit_code, 3);
  EXPECT_THAT(merged.err, HasSubstr("two different results: part/cells/" + cell + " and twin/cells/" + cell));
  write(folder_ / "tiny.ini", replaced(kTiny, "1..2", "1..3"));
  ASSERT_EQ(bench("exec tiny.ini -o more -q --shard 3/3").exit_code, 0);
  EXPECT_THAT(bench("merge part more -o third").err, HasSubstr("is of another sweep"));
}

TEST_F(Bench, WhatGoesWrongWithOneCellIsARow) {
#if defined(__SANITIZE_ADDRESS__)
  GTEST_SKIP() << "the address sanitizer does not live within a limit of memory";
#endif
  // Particles with rasters of 1 cm take hundreds of MB; a limit that the first map already breaks stands for
  // a filter that diverges.
  write(folder_ / "limits.ini",
        replaced(kTiny, "naive_wheel, naive\nseeds = 1..2", "naive_wheel, hungry, cramped\nseeds = 1") +
            "[method hungry]\nbase = rbpf\nmapping.resolution_m = 0.01\n"
            "[method cramped]\nbase = rbpf\nmapping.max_map_cells = 10000\n[limits]\nmemory_limit_mb = 60\n");
  const auto result = bench("limits.ini -o out -j 2");
  EXPECT_EQ(result.exit_code, 6) << result.err;
  const auto rows = resultsOf(folder_ / "out");
  EXPECT_EQ(rows[0]["status"], "ok") << rows[0];
  EXPECT_EQ(rows[1]["status"], "out of memory") << rows[1];
  EXPECT_EQ(rows[1]["message"], "more than 60 MB");
  EXPECT_EQ(rows[2]["status"], "failed") << rows[2];
  EXPECT_THAT(rows[2]["message"].get<std::string>(), HasSubstr("max_map_cells"));
  EXPECT_THAT(rows[2]["message"].get<std::string>(), ::testing::Not(HasSubstr(folder_.path())));
  EXPECT_TRUE(rows[2]["ate_rmse_m"].is_null());
  EXPECT_THAT(result.out, HasSubstr("failed"));
}

TEST_F(Bench, MoreComputingThanAllowedIsATimeout) {
  // A thousand filters' maps, coarse ones so that memory is no question: two seconds or more.
  write(folder_ / "slow.ini",
        replaced(kTiny, "naive_wheel, naive\nseeds = 1..2", "naive_wheel, slow\nseeds = 1") +
            "[method slow]\nbase = rbpf\nparticles.count = 1000\nmapping.resolution_m = "
            "0.2\n[limits]\ntime_limit_s = 1\n");
  EXPECT_EQ(bench("slow.ini -o out -q").exit_code, 6);
  const auto rows = resultsOf(folder_ / "out");
  EXPECT_EQ(rows[0]["status"], "ok") << rows[0];
  EXPECT_EQ(rows[1]["status"], "timeout") << rows[1];
  EXPECT_EQ(rows[1]["message"], "more than 1 s of computing");
}

/// For a line of the shell: the cell's process, whose child keeps the shell.
#define CELL "$(cut -d ' ' -f 4 /proc/$PPID/stat)"

/// A method that is a line of the shell; `awk` gives its path from the odometry.
class ShellMethod : public Bench {
 protected:
  void use(const std::string& line) {
    write(
        folder_ / "shell.ini",
        "[method]\ntype = external\ncommand = " + line +
            R"( && awk '{ printf "%s %s %s 0 0 0 %.9f %.9f\n", $1, $2, $3, sin($4 / 2), cos($4 / 2) }' {scans} > {output})"
            "\n");
    write(folder_ / "tiny.ini",
          replaced(kTiny, "naive_wheel, naive\nseeds = 1..2", "naive_wheel, shell\nseeds = 1") +
              "[method shell]\nbase = shell.ini\n");
  }
};

TEST_F(ShellMethod, ACrashIsARowAndLeavesTheOthersAlone) {
  use("kill -ABRT " CELL " && sleep 60");
  const auto result = bench("tiny.ini -o out -q");
  EXPECT_EQ(result.exit_code, 6) << result.err;
  const auto rows = resultsOf(folder_ / "out");
  EXPECT_EQ(rows[0]["status"], "ok") << rows[0];
  EXPECT_EQ(rows[1]["status"], "crashed") << rows[1];
  EXPECT_EQ(rows[1]["message"], "SIGABRT");
}

TEST_F(ShellMethod, RetryDoesAgainWhatFailedAndResumeKeepsIt) {
  use("ls {here} | grep -q mended");
  EXPECT_EQ(bench("tiny.ini -o out -q").exit_code, 6);
  EXPECT_EQ(resultsOf(folder_ / "out")[1]["status"], "failed");
  write(folder_ / "mended", "");
  EXPECT_EQ(bench("tiny.ini -o out -q --resume").exit_code, 6);
  EXPECT_EQ(resultsOf(folder_ / "out")[1]["status"], "failed");
  const auto retried = bench("tiny.ini -o out -q --resume --retry");
  EXPECT_EQ(retried.exit_code, 0) << retried.err;
  EXPECT_EQ(resultsOf(folder_ / "out")[1]["status"], "ok");
}

TEST_F(ShellMethod, ACellThatIsKilledFromOutsideIsTriedThreeTimesAndLeftForResume) {
  use("echo x >> {here}/tries && { ls {here} | grep -q mended || { kill -KILL " CELL "; sleep 60; }; }");
  const auto result = bench("tiny.ini -o out -q");
  EXPECT_EQ(result.exit_code, 6);
  EXPECT_THAT(result.err, HasSubstr("shell on flat, seed 1 (cell "));
  EXPECT_THAT(result.err, HasSubstr("): killed from outside 3 times, at last by SIGKILL"));
  EXPECT_EQ(files::readTextFile(folder_ / "tries"), "x\nx\nx\n");
  EXPECT_EQ(resultsOf(folder_ / "out")[0]["status"], "ok");
  EXPECT_EQ(resultsOf(folder_ / "out")[1]["status"], "missing");
  const auto lost = nlohmann::json::parse(bench("exec tiny.ini -o out -q --json").out);
  EXPECT_EQ(lost["lost"].size(), 1U);
  EXPECT_EQ(lost["reused"], 2);
  write(folder_ / "mended", "");
  const auto resumed = bench("tiny.ini -o out -q --resume");
  EXPECT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resultsOf(folder_ / "out")[1]["status"], "ok");
}

TEST_F(Bench, ASuiteInYamlIsTheSameSweep) {
  write(folder_ / "tiny.yaml",
        "suite:\n  worlds: flat\n  methods: [naive_wheel, naive]\n  seeds: 1..2\nlidar: {beams: 61}\n"
        "simulation: {duration_s: 5}\n");
  const auto plan = bench("plan tiny.yaml --json");
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  EXPECT_EQ(plan.out, bench("plan tiny.ini --json").out);
  const auto whole = bench("tiny.yaml -o out -q --json");
  ASSERT_EQ(whole.exit_code, 0) << whole.err;
  const auto again = bench("exec out/suite.ini -o out --json");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(nlohmann::json::parse(again.out)["reused"], 6) << again.out;
  write(folder_ / "wrong.yaml", "suite:\n  worlds: flat\n  methods: naive\n  seed: 3\n");
  const auto wrong = bench("plan wrong.yaml");
  EXPECT_EQ(wrong.exit_code, 3);
  EXPECT_THAT(wrong.err, HasSubstr("wrong.yaml:4: section [suite], unknown key 'seed'"));
}

TEST_F(Bench, CopiesOfTheRunnerAndProcessesOfTheirOwnGiveTheSameBytes) {
  const auto sweep = sweep::planSweep(folder_ / "tiny.ini");
  sweep::SweepRequest request;
  request.program = RASTERSLAM_PROGRAM;
  request.output = folder_ / "copies";
  ASSERT_TRUE(process::hasOneThread());
  EXPECT_EQ(sweep::sweep(sweep, request, {}, core::silentProgress()).done, 6U);
  // With a second thread a copy of the process would not be sound.
  request.output = folder_ / "programs";
  std::promise<void> end;
  std::thread other([&] { end.get_future().wait(); });
  EXPECT_FALSE(process::hasOneThread());
  EXPECT_EQ(sweep::sweep(sweep, request, {}, core::silentProgress()).done, 6U);
  end.set_value();
  other.join();
  EXPECT_EQ(contents(folder_ / "copies"), contents(folder_ / "programs"));
}

TEST_F(Bench, ALimitIsARowAndAHigherOneTriesAgain) {
  const std::string suite = replaced(kTiny, "naive_wheel, naive\nseeds = 1..2", "naive_wheel\nseeds = 1");
  write(folder_ / "tiny.ini", suite + "[limits]\nwall_limit_s = 0.001\n");
  EXPECT_EQ(bench("tiny.ini -o out -q").exit_code, 6);
  const auto row = resultsOf(folder_ / "out")[0];
  EXPECT_EQ(row["status"], "failed");  // its log has not come
  EXPECT_THAT(row["message"].get<std::string>(), HasSubstr("no log: timeout: more than 0.001 s"));
  EXPECT_EQ(bench("tiny.ini -o out -q --resume").exit_code, 6);
  write(folder_ / "tiny.ini", suite);
  EXPECT_EQ(bench("tiny.ini -o out -q --resume").exit_code, 0);
}

TEST_F(ShellMethod, AnInterruptLeavesTablesOfWhatIsDone) {
  // Stopped when the first run is there; the second would wait for ever.
  use("until ls {here} | grep -q go; do sleep 0.05; done");
  const auto stopped =
      testing::runCommand("cd '" + folder_.path() +
                          "' && { '" RASTERSLAM_PROGRAM
                          "' bench tiny.ini -o out -q & pid=$!; "
                          "until ls out/cells/*/run > /dev/null 2>&1; do kill -0 $pid || break; "
                          "done; kill -INT $pid; wait $pid; }");
  ASSERT_EQ(stopped.exit_code, 130) << stopped.err;
  EXPECT_THAT(files::readTextFile(folder_ / "out/summary.txt"), HasSubstr("runs are missing"));
  EXPECT_FALSE(fs::exists(folder_ / "out/partial"));
  write(folder_ / "go", "");
  ASSERT_EQ(bench("tiny.ini -o out -q --resume").exit_code, 0);
  ASSERT_EQ(bench("tiny.ini -o whole -q").exit_code, 0);
  EXPECT_EQ(contents(folder_ / "out"), contents(folder_ / "whole"));
}

TEST_F(Bench, ParametersLogsAndGeneratedBuildingsAreAxesToo) {
  ASSERT_EQ(
      rasterslam("simulate flat --duration 5 --set lidar.beams=61 -o own.rawlog", folder_.path()).exit_code,
      0);
  write(
      folder_ / "wide.ini",
      "[suite]\nworlds = flat:seed=4:width_m=12:height_m=9\nlogs = own.rawlog\nmethods = naive_wheel, graph\n"
      "faults = built-in, crowd\n[fault crowd]\nliving.people = 3\n[lidar]\nbeams = 61\n"
      "[simulation]\nduration_s = 5\n[parameters naive_wheel]\nmapping.resolution_m = 0.05, 0.1\n");
  const auto result = bench("wide.ini -o out -q -j 2");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto rows = resultsOf(folder_ / "out");
  ASSERT_EQ(rows.size(),
            9U);  // two logs to simulate and one that is there; two choices of naive_wheel and graph
  EXPECT_EQ(rows[1]["parameters"], "mapping.resolution_m=0.1");
  EXPECT_EQ(rows[3]["fault"], "crowd");
  EXPECT_EQ(rows[6]["world"], "own");
  for (const auto& row : rows) {
    EXPECT_EQ(row["status"], "ok") << row;
    EXPECT_LT(row["ate_rmse_m"].get<double>(), 1) << row;
    EXPECT_GT(row["wall_f1"].get<double>(), 0.2) << row;
  }
}

TEST_F(Bench, ASuiteThatIsWrongSaysWhereBeforeAnythingRuns) {
  const auto expect = [&](const std::string& what, const std::string& with, const std::string& message) {
    write(folder_ / "bad.ini", replaced(kTiny, what, with));
    const auto result = bench("bad.ini -o out");
    EXPECT_EQ(result.exit_code, 3) << with;
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_FALSE(fs::exists(folder_ / "out"));
  };
  expect("naive\n", "nave\n", "bad.ini:3: section [suite], key 'methods': found 'nave'");
  expect("naive\n", "nave\n", "did you mean 'naive'?");
  expect("flat", "flatt", "bad.ini:2: section [suite], key 'worlds'");
  expect("flat", "office:width_m=1", "bad.ini:2");
  expect("seeds", "seed", "bad.ini:4: section [suite], unknown key 'seed'; did you mean 'seeds'?");
  expect("1..2", "2..1", "bad.ini:4");
  expect("1..2", "1, 1", "expected each seed once");
  expect("beams = 61", "beems = 61", "bad.ini:6: section [lidar], unknown key 'beems'");
  expect("beams = 61", "beams = 0", "bad.ini:6");
  expect("[lidar]", "[lidar odd]", "section [lidar odd] is named by no list");
  expect("[lidar]", "[liddar]", "unknown section [liddar]; did you mean 'lidar'?");
  expect("naive\n", "naive\nlidars = lms292\n", "did you mean 'lms291'?");
  expect("naive\n", "naive\nstrategies = nearest_frontier\n", "needs a map");
  expect("naive\n", "naive\nbaseline = icp\n", "key 'baseline': found 'icp'");
  expect("_s = 5\n", "_s = 5\n[parameters naive]\nmapping.resolutoin_m = 1\n", "unknown key 'resolutoin_m'");
  expect("naive\n", "naive_wheel\n", "'naive_wheel' is named twice");
  EXPECT_THAT(bench("exec tiny.ini -o out --shard 3/2").err, HasSubstr("--shard: found '3/2'"));
  EXPECT_THAT(bench("exec tiny.ini -o out --cell 12").err, HasSubstr("--cell: found '12'"));
}

TEST_F(Bench, ThePlanListsTheCellsAndOtherInputsGiveOtherIds) {
  const auto listed = bench("plan tiny.ini --json");
  ASSERT_EQ(listed.exit_code, 0) << listed.err;
  const auto plan = nlohmann::json::parse(listed.out);
  EXPECT_EQ(plan["logs"].size(), 2U);
  EXPECT_EQ(plan["runs"].size(), 4U);
  std::set<std::string> ids;
  for (const char* kind : {"logs", "runs"})
    for (const auto& cell : plan[kind]) ids.insert(cell["id"].get<std::string>());
  EXPECT_EQ(ids.size(), 6U);
  write(folder_ / "tiny.ini", replaced(kTiny, "= 5", "= 6"));
  const auto changed = nlohmann::json::parse(bench("plan tiny.ini --json").out);
  EXPECT_EQ(changed["runs"].size(), 4U);
  for (const auto& run : changed["runs"]) EXPECT_EQ(ids.count(run["id"].get<std::string>()), 0U);
  // The name of the file and the order of its lines are not in an id.
  write(folder_ / "other.ini", std::string("# the same\n") + kTiny);
  const auto other = nlohmann::json::parse(bench("plan other.ini --json").out);
  EXPECT_EQ(other["runs"], plan["runs"]);
}

TEST_F(Bench, TheScriptsForOthersGoOnWhereTheyWere) {
  const auto written = bench("submit tiny.ini -o out --engine slurm --tasks 3 --option=--partition=long");
  ASSERT_EQ(written.exit_code, 0) << written.err;
  const std::string batch = files::readTextFile(folder_ / "out/submit/sweep.sbatch");
  EXPECT_THAT(batch, HasSubstr("#SBATCH --array=1-3\n"));
  EXPECT_THAT(batch, HasSubstr("#SBATCH --partition=long\n"));
  EXPECT_THAT(files::readTextFile(folder_ / "out/submit/submit.sh"), HasSubstr("--dependency=\"afterany:"));
  EXPECT_THAT(bench("submit tiny.ini -o out --engine parallel").err, HasSubstr("--resume"));
  ASSERT_EQ(bench("submit tiny.ini -o out --engine parallel --tasks 2 --resume").exit_code, 0);
  const std::string tasks = files::readTextFile(folder_ / "out/submit/tasks.txt");
  EXPECT_EQ(std::count(tasks.begin(), tasks.end(), '\n'), 2);
  // What GNU parallel would do.
  ASSERT_EQ(testing::runCommand("sh '" + folder_.path() + "/out/submit/tasks.txt'").exit_code, 0);
  EXPECT_EQ(bench("merge out").exit_code, 0);
}

}  // namespace
}  // namespace slam::apps
