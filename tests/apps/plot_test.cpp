#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "libslam/files/files.h"
#include "libslam/resources/file_hash.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

bool isPicture(const std::string& path) {
  return fs::exists(path) && !cv::imread(path).empty();
}

/// A recording of three seconds, made once per test.
void simulate(const testing::TempFolder& folder) {
  const auto result = rasterslam("simulate flat -o run.rawlog --duration 3 -q", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
}

TEST(Plot, DrawsAnyScanOfALog) {
  const testing::TempFolder folder;
  simulate(folder);
  const auto first = rasterslam("plot scan run.rawlog", folder.path());
  ASSERT_EQ(first.exit_code, 0) << first.err;
  EXPECT_EQ(first.out, "scan.png\n");
  const auto last = rasterslam("plot scan run.rawlog --index 15 -o last.png --json", folder.path());
  ASSERT_EQ(last.exit_code, 0) << last.err;
  const auto facts = nlohmann::json::parse(last.out);
  EXPECT_EQ(facts["index"], 15);
  EXPECT_EQ(facts["beams"], 541);
  EXPECT_NEAR(facts["time_s"].get<double>(), 1700000003, 1e-6);
  EXPECT_TRUE(isPicture(folder / "scan.png"));
  EXPECT_TRUE(isPicture(folder / "last.png"));
  EXPECT_NE(resources::fileSha256(folder / "scan.png"), resources::fileSha256(folder / "last.png"));
}

TEST(Plot, RefusesAScanThatTheLogDoesNotHold) {
  const testing::TempFolder folder;
  simulate(folder);
  for (const std::string index : {"16", "-1", "2000000000"}) {
    const auto result = rasterslam("plot scan run.rawlog --index " + index + " -o x.png", folder.path());
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_EQ(result.err, "rasterslam: run.rawlog: --index: found " + index + ", expected 0 to 15\n");
  }
  EXPECT_EQ(rasterslam("plot scan run.rawlog --index two -o x.png", folder.path()).exit_code, 2);
  EXPECT_THAT(rasterslam("plot scan none.rawlog", folder.path()).err, HasSubstr("none.rawlog: no such file"));
  EXPECT_FALSE(fs::exists(folder / "x.png"));
  EXPECT_FALSE(fs::exists(folder / "scan.png"));
}

TEST(Plot, ReplaysAnOperationLogOverItsTruthAndPlan) {
  const testing::TempFolder folder;
  simulate(folder);
  const auto result = rasterslam("plot operations run.operations.txt --json", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto facts = nlohmann::json::parse(result.out);
  EXPECT_GE(facts["operations"], 1);
  EXPECT_LE(facts["operations"], 15) << "3 s at 5 Hz, in whole commands";
  EXPECT_GT(facts["dots"], 20) << "the scans lie beside it";
  EXPECT_THAT(facts["truth"].get<std::string>(), HasSubstr("run.gt.tum"));
  EXPECT_THAT(facts["plan"].get<std::string>(), HasSubstr("flat.yaml"));
  EXPECT_TRUE(isPicture(folder / "operations.png"));
}

TEST(Plot, ReplaysAnOperationLogThatStandsAlone) {
  const testing::TempFolder folder;
  std::ofstream(folder / "square.txt")
      << "m -1 1\nt 1.5707963267948966\nm 0 1\nt 1.5707963267948966\nm -1 0\n";
  const auto result = rasterslam("plot operations square.txt -o square.png", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("5 operations, path 3.00 m, end at x 0.00 m, y 1.00 m, yaw 180.0 deg"));
  EXPECT_TRUE(isPicture(folder / "square.png"));
  files::writeFileAtomically(folder / "empty.txt", "");
  EXPECT_EQ(rasterslam("plot operations empty.txt -o empty.png", folder.path()).exit_code, 0);
}

TEST(Plot, RefusesABrokenOperationLogAndAPlanWithoutAStart) {
  const testing::TempFolder folder;
  std::ofstream(folder / "cut.txt") << "m -1 1\nt 1.57";
  std::ofstream(folder / "good.txt") << "m -1 1\n";
  const auto cut = rasterslam("plot operations cut.txt", folder.path());
  EXPECT_EQ(cut.exit_code, 3);
  EXPECT_THAT(cut.err, HasSubstr("cut.txt:2: the last line has no line end"));
  const auto no_start = rasterslam("plot operations good.txt --plan flat", folder.path());
  EXPECT_EQ(no_start.exit_code, 3);
  EXPECT_THAT(no_start.err, HasSubstr("--plan needs --truth"));
  EXPECT_FALSE(fs::exists(folder / "operations.png"));
}

TEST(Plot, DrawsTheTurnAwayExperimentWithCameraAndLidar) {
  const testing::TempFolder folder;
  const auto camera = rasterslam("plot obstacles --json", folder.path());
  ASSERT_EQ(camera.exit_code, 0) << camera.err;
  const auto moments = nlohmann::json::parse(camera.out)["moments"];
  ASSERT_EQ(moments.size(), 6U);
  EXPECT_EQ(moments[0]["seen"], 7);
  EXPECT_EQ(moments[3]["seen"], 0);
  EXPECT_EQ(moments[3]["remembered"], 5);
  ASSERT_EQ(rasterslam("plot obstacles --sensor lidar -o lidar.png", folder.path()).exit_code, 0);
  EXPECT_TRUE(isPicture(folder / "obstacles.png"));
  EXPECT_TRUE(isPicture(folder / "lidar.png"));
  const auto again = rasterslam("plot obstacles", folder.path());
  EXPECT_EQ(again.exit_code, 3);
  EXPECT_THAT(again.err, HasSubstr("obstacles.png: exists; give --overwrite to replace it"));
}

TEST(Plot, SaysTheSizesOfPlansShort) {
  const testing::TempFolder folder;
  const auto drawn = rasterslam("plot plans flat office_loop --json", folder.path());
  ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
  EXPECT_THAT(drawn.out, HasSubstr("\"13.6 x 10.6 m\""));  // not 13.600000000000001
  EXPECT_TRUE(isPicture(folder / "plans.png"));
}

TEST(Plot, PrintsAndChecksTheObstacleParameters) {
  const testing::TempFolder folder;
  const auto printed = rasterslam("plot obstacles --print-config --set camera.pitch_deg=30", folder.path());
  ASSERT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_THAT(printed.out, HasSubstr("[obstacles]"));
  EXPECT_THAT(printed.out, HasSubstr("pitch_deg = 30"));
  for (const auto& [arguments, message] : {std::pair{"--sensor sonar", "found 'sonar', expected"},
                                           {"--set camera.pich_deg=3", "did you mean 'pitch_deg'?"},
                                           {"--set obstacles.max_points=0", "key 'max_points': found '0'"},
                                           {"--set kamera.x_m=0", "did you mean 'camera'?"}}) {
    const auto result = rasterslam(std::string("plot obstacles ") + arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Plot, DrawsAComparisonInEveryFormat) {
  const testing::TempFolder folder;
  const auto compared =
      rasterslam("compare flat --methods naive_wheel,icp,graph --duration 3 -o out -q", folder.path());
  ASSERT_EQ(compared.exit_code, 0) << compared.err;
  for (const std::string kind : {"map", "paths", "errors", "cost", "consistency"}) {
    for (const std::string extension : {"pdf", "svg", "png"}) {
      const auto file = kind + "." + extension;
      const auto drawn = rasterslam("plot " + kind + " out --width 85mm -o " + file, folder.path());
      ASSERT_EQ(drawn.exit_code, 0) << drawn.err;
      EXPECT_EQ(drawn.out, file + "\n");
    }
    EXPECT_THAT(files::readTextFile(folder / (kind + ".svg")), HasSubstr("width=\"85mm\""));
    EXPECT_THAT(files::readTextFile(folder / (kind + ".svg")),
                HasSubstr(kind == "consistency" ? ">graph final</text>"
                          : kind == "cost"      ? ">icp, mean</text>"
                                                : ">icp</text>"));
    EXPECT_EQ(cv::imread(folder / (kind + ".png")).cols, 1004);  // 300 dpi
  }
  const auto one = rasterslam("plot paths out -q --methods icp -o one.svg --json", folder.path());
  ASSERT_EQ(one.exit_code, 0) << one.err;
  EXPECT_EQ(nlohmann::json::parse(one.out)["paths"], nlohmann::json({"icp", "true path"}));
  EXPECT_THAT(files::readTextFile(folder / "one.svg"), HasSubstr("width=\"170mm\""));  // a page
  const auto unknown = rasterslam("plot errors out -q --methods icq -o no.svg", folder.path());
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.err,
              HasSubstr("--methods: found 'icq', expected a method in out; did you mean 'icp'?"));
  EXPECT_FALSE(fs::exists(folder / "no.svg"));
}

TEST(Plot, DrawsTablesThatAnybodyMayWrite) {
  const testing::TempFolder folder;
  std::ofstream(folder / "results.csv")
      << "world,seed,method,status,ate_final_m\nflat,1,icp,ok,0.1\nflat,2,icp,ok,0.2\n";
  const auto seeds = rasterslam("plot seeds results.csv --json", folder.path());
  ASSERT_EQ(seeds.exit_code, 0) << seeds.err;
  EXPECT_EQ(nlohmann::json::parse(seeds.out)["boxes"][0]["values"], 2);
  EXPECT_TRUE(isPicture(folder / "seeds.png"));
  const auto metric = rasterslam("plot seeds . --metric wall_f1 -o w.pdf", folder.path());
  EXPECT_EQ(metric.exit_code, 3);
  EXPECT_THAT(metric.err, HasSubstr("./results.csv:1: names no column 'wall_f1'"));
  std::ofstream(folder / "broken.csv") << "a,b\n1\n";
  EXPECT_THAT(rasterslam("plot stress broken.csv", folder.path()).err,
              HasSubstr("broken.csv:2: found 1 fields, expected 2"));
  EXPECT_THAT(rasterslam("plot stress .", folder.path()).err, HasSubstr("stress.csv: no such file"));
  EXPECT_THAT(rasterslam("plot exploration .", folder.path()).err, HasSubstr("holds no exploration.csv"));
  EXPECT_FALSE(fs::exists(folder / "w.pdf"));
}

TEST(Plot, RefusesExtensionsAndSizesBeforeAnyWork) {
  const testing::TempFolder folder;
  for (const auto& [arguments, message] :
       {std::pair{"-o x.jpg", "x.jpg: found extension '.jpg', expected .png, .svg or .pdf"},
        {"-o x.pdf --width 8", "--width: found 8 mm with text of 8 pt, expected 50 to 2000 mm"},
        {"-o x.pdf --width wide", "--width: found 'wide', expected a length above 0 in mm, cm, in, pt"},
        {"-o x.pdf --width -3cm", "--width: found '-3cm'"},
        {"-o x.pdf --font 0pt", "--font: found '0pt'"}}) {
    const auto result = rasterslam(std::string("plot plans flat ") + arguments, folder.path());
    EXPECT_EQ(result.exit_code, 3) << arguments;
    EXPECT_THAT(result.err, HasSubstr(message));
  }
  EXPECT_EQ(rasterslam("plot plans flat --dpi 1", folder.path()).exit_code, 2);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(Plot, WantsToKnowWhatToDraw) {
  for (const std::string arguments : {"plot", "plot map", "plot seeds", "plot scan", "plot operations"})
    EXPECT_EQ(rasterslam(arguments).exit_code, 2) << arguments;
}

}  // namespace
}  // namespace slam::apps
