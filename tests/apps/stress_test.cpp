#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libslam/files/files.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;

void write(const std::string& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Wheels that slip more and more under a method that believes them.
constexpr const char* kSlipping =
    "stress flat --vary odometry.slips_per_m=0.01,30 --set odometry.slip_m=0.1 --methods naive_wheel "
    "--seeds 2 --duration 40 --set lidar.beams=31";

TEST(Stress, FindsWhereWheelsThatSlipBreakAMethodAndSaysWhy) {
  const testing::TempFolder folder;
  const auto one = rasterslam(std::string(kSlipping) + " -o one", folder.path());
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_THAT(one.out, HasSubstr("naive_wheel: breaks at 30 and above (holds at 0.01)"));
  EXPECT_TRUE(fs::exists(folder / "one/stress.png"));
  const auto manifest = nlohmann::json::parse(files::readTextFile(folder / "one/manifest.json"));
  for (const auto& [file, meaning] : manifest["files"].items())
    EXPECT_TRUE(fs::exists(folder / ("one/" + file))) << meaning;
  EXPECT_TRUE(manifest["files"].contains("stress.png"));
  EXPECT_TRUE(manifest["files"].contains("results.csv"));
  EXPECT_THAT(files::readTextFile(folder / "one/plan.json"), Not(HasSubstr(folder.path())));
  const auto failures = nlohmann::json::parse(files::readTextFile(folder / "one/failures.json"))["rows"];
  nlohmann::json failure;  // of the wheels that slip much
  int slipped = 0;
  for (const auto& row : failures) {
    if (row["fault"] != "odometry.slips_per_m=30") continue;
    ++slipped;
    failure = row;
    EXPECT_EQ(row["suspect"], "slip");
    EXPECT_GT(row["time_s"], 0);
  }
  ASSERT_EQ(slipped, 2);
  // The same bytes with two jobs, and of cells that are there already.
  ASSERT_EQ(rasterslam(std::string(kSlipping) + " -o two -j 2", folder.path()).exit_code, 0);
  for (const char* name : {"stress.csv", "stress.tex", "stress.png", "failures.csv", "suite.ini"})
    EXPECT_EQ(files::readTextFile(folder / ("one/" + std::string(name))),
              files::readTextFile(folder / ("two/" + std::string(name))))
        << name;
  EXPECT_THAT(rasterslam(std::string(kSlipping) + " -o two", folder.path()).err, HasSubstr("--resume"));
  EXPECT_EQ(rasterslam(std::string(kSlipping) + " -o two --resume", folder.path()).out,
            rasterslam(std::string(kSlipping) + " -o two --resume", folder.path()).out);

  // The run's folder by itself says the same.
  const std::string cell = "one/" + failure["folder"].get<std::string>() + "/run";
  const auto logs = nlohmann::json::parse(files::readTextFile(folder / "one/results.json"))["rows"];
  std::string log;
  for (const auto& row : logs)
    if (row["run"] == failure["run"]) log = "one/" + row["log_folder"].get<std::string>();
  const auto eval = rasterslam("eval " + cell + " --truth " + log + "/run.gt.tum --plan flat", folder.path());
  ASSERT_EQ(eval.exit_code, 0) << eval.err;
  EXPECT_THAT(eval.out, HasSubstr("first divergence"));
  EXPECT_THAT(eval.out, HasSubstr("worst region of the map"));
}

TEST(Tune, JudgesOnHeldOutWorldsAndGoesOnWhereItWas) {
  const testing::TempFolder folder;
  write(folder / "tiny.ini",
        "[suite]\nworlds = flat, office\nmethods = icp\nodometry = good\n"
        "[odometry good]\n"  // without keys: the wheels as they are built in
        "[tune]\ntrain = flat\nhold_out = office\nhold_out_seeds = 2\n"
        "[world office]\nkind = office\nseed = 3\nwidth_m = 20\nheight_m = 15\n"
        "[tune.parameters]\nicp.decimation = 1..4\nicp.min_goodness = 0.2..0.6\n"
        "[lidar]\nbeams = 61\n[simulation]\nduration_s = 5\n");
  const std::string command = "tune icp tiny.ini --budget 12 -q";
  const auto one = rasterslam(command + " -o one", folder.path());
  ASSERT_EQ(one.exit_code, 0) << one.err;
  const std::string tuned = files::readTextFile(folder / "one/icp_tuned.ini");
  EXPECT_THAT(tuned, HasSubstr("# icp tuned on tiny.ini (worlds flat), budget 12 runs, seed 1."));
  EXPECT_THAT(tuned, HasSubstr("decimation"));
  ASSERT_EQ(rasterslam(command + " -o two -j 2", folder.path()).exit_code, 0);
  fs::remove_all(folder / "two/held_out");
  fs::remove_all(fs::directory_iterator(folder / "two/training/cells")->path());
  ASSERT_EQ(rasterslam(command + " -o two --resume", folder.path()).exit_code, 0);
  for (const char* name : {"icp_tuned.ini", "candidates.csv", "sensitivity.csv", "verdict.txt"})
    EXPECT_EQ(files::readTextFile(folder / ("one/" + std::string(name))),
              files::readTextFile(folder / ("two/" + std::string(name))))
        << name;
  // What came out is a method like any other.
  std::string log;
  for (const auto& cell : fs::directory_iterator(folder / "one/training/cells"))
    if (fs::exists(cell.path() / "run.rawlog")) log = (cell.path() / "run.rawlog").string();
  const auto page = rasterslam("report one -o tuned.html", folder.path());
  EXPECT_EQ(page.exit_code, 0) << page.err;
  EXPECT_THAT(files::readTextFile(folder / "tuned.html"), HasSubstr("<title>Tuning"));
  const auto run = rasterslam("run one/icp_tuned.ini " + log + " -o again -q", folder.path());
  EXPECT_EQ(run.exit_code, 0) << run.err;
}

TEST(Stress, AnOfficeOfOneCorridorTakesAnyLength) {
  const testing::TempFolder folder;
  const auto result = rasterslam(
      "stress office:height_m=12 --vary world.width_m=20,50 --methods naive_wheel --seeds 1 --duration 5 "
      "--set lidar.beams=31 -o out -q",
      folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto rows = nlohmann::json::parse(files::readTextFile(folder / "out/results.json"))["rows"];
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0]["world"], "office height_m=12 width_m=20");
  EXPECT_EQ(rows[1]["status"], "ok");
}

TEST(Tune, SaysWhatTheSuiteLacks) {
  const testing::TempFolder folder;
  const auto error = [&](const std::string& tune, const std::string& more = "") {
    write(folder / "s.ini", "[suite]\nworlds = flat, corridor\nmethods = icp\n" + tune + more);
    const auto result = rasterslam("tune icp s.ini --budget 12 -o out", folder.path());
    EXPECT_EQ(result.exit_code, 3);
    return result.err;
  };
  EXPECT_THAT(error(""), HasSubstr("key 'train': names no world"));
  EXPECT_THAT(error("[tune]\ntrain = flat\nhold_out = corrido\n"), HasSubstr("'corridor'"));
  EXPECT_THAT(error("[tune]\ntrain = flat\nhold_out = flat\n"), HasSubstr("training worlds too"));
  EXPECT_THAT(
      error("[tune]\ntrain = flat\nhold_out = corridor\n", "[tune.parameters]\nicp.decimation = 4..1\n"),
      HasSubstr("s.ini:8"));
  EXPECT_THAT(
      error("[tune]\ntrain = flat\nhold_out = corridor\n", "[tune.parameters]\nicp.decimatio = 1..4\n"),
      HasSubstr("decimation"));
}

}  // namespace
}  // namespace slam::apps
