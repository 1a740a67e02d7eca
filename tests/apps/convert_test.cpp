#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/testing/temp_folder.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// A robot that drives ahead, 0.5 m a scan, and knows its true pose.
std::string smallLog(int scans = 6) {
  std::string text = "PARAM robot_frontlaser_offset 0.1 nohost 0\n";
  for (int i = 0; i < scans; ++i) {
    const std::string x = std::to_string(0.5 * i), time = std::to_string(1000.25 + 0.25 * i);
    const std::string tail = time + " host " + std::to_string(0.25 * i) + "\n";
    text += "TRUEPOS " + x + " 0.1 0 " + x + " 0.000000 0.000000 " + tail;
    text += "FLASER 5 2.00 2.10 2.20 81.83 2.40 " + std::to_string(0.5 * i + 0.1) + " 0.000000 0.000000 " +
            x + " 0.000000 0.000000 " + tail;
  }
  return text;
}

TEST(Convert, WritesARawlogThatInfoReadsAndTheTruthBesideIt) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", smallLog() + "SONAR 1 2 3\n");
  const auto result = rasterslam("convert a.clf a.rawlog", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("read      a.clf (CARMEN log)"));
  EXPECT_THAT(result.out, HasSubstr("scans     6 from \"FLASER\""));
  EXPECT_THAT(result.out, HasSubstr("truth     6 poses, beside the log"));
  EXPECT_THAT(result.out, HasSubstr("skipped   1 line kept as text only (1 SONAR)"));
  EXPECT_THAT(result.out, HasSubstr("wrote     a.rawlog ("));
  EXPECT_THAT(result.err, HasSubstr("converting to MRPT rawlog"));
  const auto info = nlohmann::json::parse(rasterslam("info a.rawlog --json", folder.path()).out);
  EXPECT_EQ(info["scans"], 6);
  EXPECT_EQ(info["form"], "observation only");
  EXPECT_EQ(info["mount"][0], 0.1);
  EXPECT_EQ(info["truth"], "a.truth.tum");
  EXPECT_EQ(info["odometry_length_m"], 2.5);
  const auto truth = logs::readTum(folder / "a.truth.tum");
  ASSERT_EQ(truth.size(), 6U);
  EXPECT_EQ(truth[2].pose.x, 1);
  EXPECT_EQ(truth[2].pose.y, 0.1);
  EXPECT_EQ(logs::readMrptGroundTruth(folder / "a.rawlog.GT.txt").size(), 6U);
}

TEST(Convert, TakesTheFormatFromTheSuffixOrFromTo) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", smallLog());
  const auto run = [&folder](const std::string& arguments) {
    return rasterslam("convert " + arguments + " -q --json --overwrite", folder.path());
  };
  EXPECT_EQ(run("a.clf x --to rawlog --form action").exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(rasterslam("info x --json", folder.path()).out)["form"],
            "action / sensory frame");
  EXPECT_EQ(nlohmann::json::parse(run("x back.clf").out)["from"], "MRPT rawlog");
  EXPECT_EQ(nlohmann::json::parse(rasterslam("info back.clf --json", folder.path()).out)["scans"], 6);
  EXPECT_EQ(run("x again --to rawlog --form observation").exit_code, 0);
  EXPECT_EQ(nlohmann::json::parse(rasterslam("info again --json", folder.path()).out)["form"],
            "observation only");
}

TEST(Convert, GivesTheOdometryOrTheTruthOfALogAsATrajectory) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", smallLog());
  ASSERT_EQ(rasterslam("convert a.clf a.tum -q", folder.path()).exit_code, 0);
  EXPECT_EQ(logs::readTrajectory(folder / "a.tum").back().pose.x, 2.5);
  ASSERT_EQ(rasterslam("convert a.clf t.csv --path truth -q", folder.path()).exit_code, 0);
  EXPECT_EQ(files::readTextFile(folder / "t.csv").substr(0, 88),
            "time_s,x_m,y_m,yaw_rad\n"
            "1000.250000,0.000000000,0.100000000,0.000000000\n1000.500000,0.500");
}

TEST(Convert, TurnsTrajectoriesIntoEachOther) {
  const testing::TempFolder folder;
  const core::Trajectory path = {{1, {0, 0, 0}}, {1.5, {1, 2, 3}}, {2, {2, 0, -3}}};
  logs::writeTum(path, folder / "a.tum");
  for (const auto* step : {"a.tum b.csv", "b.csv c.GT.txt", "c.GT.txt d.tum"})
    ASSERT_EQ(rasterslam(std::string("convert ") + step, folder.path()).exit_code, 0) << step;
  const auto back = logs::readTrajectory(folder / "d.tum");
  ASSERT_EQ(back.size(), path.size());
  for (size_t i = 0; i < path.size(); ++i) {
    EXPECT_EQ(back[i].time_s, path[i].time_s);
    EXPECT_NEAR(back[i].pose.x, path[i].pose.x, 1e-9);
    EXPECT_NEAR(back[i].pose.phi, path[i].pose.phi, 1e-6) << "MRPT's form has 6 decimals";
  }
}

TEST(Convert, SaysWhatIsWrongInOneLine) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", smallLog());
  files::writeFileAtomically(folder / "bad.clf", smallLog() + "ODOM 1 2 three 0 0 0 5 host 0\n");
  files::writeFileAtomically(folder / "there.rawlog", "something");
  const auto errorOf = [&folder](const std::string& arguments) {
    const auto result = rasterslam("convert " + arguments + " -q", folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    return result.err;
  };
  EXPECT_THAT(errorOf("a.clf out.xyz"),
              HasSubstr("out.xyz: its name says no format, expected one of .rawlog"));
  EXPECT_THAT(errorOf("a.clf out --to ascii"),
              HasSubstr("--to: found 'ascii', expected one of rawlog, carmen"));
  EXPECT_THAT(errorOf("a.clf out.clf --form action"), HasSubstr("--form: is of rawlogs"));
  EXPECT_THAT(errorOf("a.clf out.rawlog --form frames"), HasSubstr("expected action or observation"));
  EXPECT_THAT(errorOf("a.clf out.tum --path true"), HasSubstr("--path: found 'true'"));
  EXPECT_THAT(errorOf("a.clf there.rawlog"), HasSubstr("there.rawlog: exists; give --overwrite"));
  EXPECT_THAT(errorOf("a.clf out.rawlog --label REAR"),
              HasSubstr("a.clf: no laser scan with the sensor label 'REAR', found 'FLASER' (6 scans)"));
  EXPECT_THAT(errorOf("bad.clf out.rawlog"),
              HasSubstr("bad.clf:14: found 'three', expected x y theta (a finite number)"));
  EXPECT_THAT(errorOf("none.clf out.rawlog"), HasSubstr("none.clf: no such file"));
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) files += entry.exists() ? 1 : 0;
  EXPECT_EQ(files, 3U) << "nothing half-written is left";
}

TEST(Convert, AnInterruptLeavesNothing) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", smallLog(100000));
  const auto stopped = testing::runCommand("cd '" + folder.path() +
                                           "' && { '" RASTERSLAM_PROGRAM
                                           "' convert a.clf a.rawlog -q & pid=$!; "
                                           "while ! ls a.rawlog.rasterslam-* >/dev/null 2>&1 && kill -0 "
                                           "$pid; do :; done; kill -INT $pid; wait $pid; }");
  ASSERT_EQ(stopped.exit_code, 130) << stopped.err;
  size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder.path())) files += entry.exists() ? 1 : 0;
  EXPECT_EQ(files, 1U) << "only a.clf";
}

TEST(AnOperationLog, GoesToTheOriginalFormAndBack) {
  const testing::TempFolder folder;
  const auto in = [&](const std::string& command) { return rasterslam(command, folder.path()); };
  files::writeFileAtomically(folder / "run.operations.txt", "m -0.5 0.52 0 6\nt 0.3490658503988659 6 7\n");
  ASSERT_EQ(in("convert run.operations.txt old.original.txt --pixel 0.1").exit_code, 0);
  EXPECT_EQ(files::readTextFile(folder / "old.original.txt"), "m\n-5\n5\nt\n20\n");
  const auto back = in("convert old.original.txt new.operations.txt --pixel 0.1");
  ASSERT_EQ(back.exit_code, 0) << back.err;
  EXPECT_EQ(files::readTextFile(folder / "new.operations.txt"), "m -0.5 0.5\nt 0.3490658503988659\n");
  EXPECT_THAT(in("plot operations old.original.txt --pixel 0.1 -o old.png").out,
              HasSubstr("2 operations, path 0.50 m"));
}

TEST(AnOperationLog, BecomesNothingElse) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "old.txt", "m\n1\n");
  const auto cut = rasterslam("convert old.txt new.operations.txt", folder.path());
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_THAT(cut.err, HasSubstr("old.txt:2: the log ends here"));
  const auto log = rasterslam("convert old.txt new.rawlog", folder.path());
  EXPECT_EQ(log.exit_code, 3);
  EXPECT_THAT(log.err, HasSubstr("an operation log becomes another operation log"));
  EXPECT_FALSE(fs::exists(folder / "new.operations.txt"));
}

TEST(ACarmenLog, IsMappedAndComparedDirectly) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "a.clf", smallLog());
  const auto run = rasterslam("run naive_wheel a.clf -o out", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("6 scans, path 2.50 m"));
  const auto compared = rasterslam("compare a.clf --methods naive_wheel -o both", folder.path());
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("naive_wheel"));
}

TEST(ACarmenLog, WhoseStampsRunBackGivesATrajectoryInTheOrderOfStamps) {
  const testing::TempFolder folder;
  std::string text = smallLog();
  // The third scan is stamped before the second.
  for (size_t at; (at = text.find("1000.750000")) != std::string::npos;) text.replace(at, 11, "1000.400000");
  files::writeFileAtomically(folder / "a.clf", text);
  const auto run = rasterslam("run naive_wheel a.clf -o out", folder.path());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("path 2.50 m, end at x 2.50 m")) << "as the robot drove";
  const auto path = logs::readTum(folder / "out/trajectory.tum");
  EXPECT_EQ(path[1].time_s, 1000.4);
  EXPECT_EQ(path[1].pose.x, 1);
  EXPECT_EQ(path[2].pose.x, 0.5);
}

}  // namespace
}  // namespace slam::apps
