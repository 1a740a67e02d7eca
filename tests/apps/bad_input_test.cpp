#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "libslam/files/files.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/logs/log_writer.h"
#include "tests/apps/program.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// One line on standard error that says `what`, the exit code, and not a file more in the folder than before.
void expectRefusal(const testing::TempFolder& folder, const std::string& arguments, int exit_code,
                   const std::string& what) {
  const auto count = [&] {
    return std::distance(fs::recursive_directory_iterator(folder.path()), fs::recursive_directory_iterator());
  };
  const auto before = count();
  const auto result = rasterslam(arguments, folder.path());
  EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.err;
  EXPECT_THAT(result.err, HasSubstr(what)) << arguments;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(count(), before) << arguments << " left something behind";
}

/// A room of 60 x 40 cells with walls all round.
cv::Mat roomPicture() {
  cv::Mat picture(40, 60, CV_8UC1, cv::Scalar(255));
  for (const int row : {0, 39}) picture.row(row).setTo(0);
  for (const int column : {0, 59}) picture.col(column).setTo(0);
  return picture;
}

lidar::Scan smallScan(double time_s, int beams) {
  lidar::Scan scan;
  scan.time_s = 1700000000 + time_s;
  scan.first_angle_rad = -1;
  scan.step_rad = beams > 1 ? 2.0 / (beams - 1) : 1.0;
  scan.max_range_m = 10;
  scan.ranges_m.assign(static_cast<size_t>(beams), 2.0F);
  return scan;
}

void writeLog(const std::string& path, int entries, bool has_odometry = true) {
  logs::LogWriter writer(path, rawlogs::RawlogForm::kActionFrame);
  for (int i = 0; i < entries; ++i)
    writer.write({smallScan(0.2 * i, 31), {0.0, 0, 0}, {0.0, 0, 0}, has_odometry});
  writer.close();
}

TEST(BadInput, IsQuotedInOneShortLineThatATerminalCanShow) {
  const testing::TempFolder folder;
  files::writeFileAtomically(folder / "plan.yaml",
                             "image: x.png\nresolution: '\x1b[31m" + std::string(9000, '7') + "'\n");
  const auto result = rasterslam("simulate plan.yaml", folder.path());
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_LE(result.err.size(), 320U);
  EXPECT_EQ(result.err.find('\x1b'), std::string::npos);
}

// Names come from the shell and from the files themselves; letters may come in pieces of a buffer's size.
TEST(BadInput, IsPrintedWithoutWhatATerminalWouldObey) {
  const testing::TempFolder folder;
  const std::string name = "scan\x1b[31m\xff_\u00fc.rawlog";
  auto scan = smallScan(0, 31);
  {
    mrpt::io::CFileGZOutputStream file(folder / name);
    auto log = mrpt::serialization::archiveFrom(file);
    const auto observation = lidar::toMrpt(scan);
    observation->timestamp = mrpt::Clock::fromDouble(scan.time_s);
    observation->sensorLabel = "front\x1b]0;\x07";
    for (int i = 0; i < 9000; ++i) observation->sensorLabel += "\u00fc";
    log << *observation;
  }
  const auto result = rasterslam("info '" + name + "'", folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("scan\\x1b[31m\\xff_\u00fc.rawlog"));
  EXPECT_THAT(result.out, HasSubstr("front\\x1b]0;\\x07"));
  EXPECT_EQ(result.out.find('\x1b'), std::string::npos);
  EXPECT_EQ(result.out.find("\\xc3"), std::string::npos) << "letters are whole wherever a buffer ends";
}

TEST(BadInput, PlansThatAreNone) {
  const testing::TempFolder folder;
  cv::imwrite(folder / "room.png", roomPicture());
  cv::imwrite(folder / "white.png", cv::Mat(20, 20, CV_8UC1, cv::Scalar(255)));
  cv::imwrite(folder / "black.png", cv::Mat(20, 20, CV_8UC1, cv::Scalar(0)));
  const std::string whole = files::readTextFile(folder / "room.png");
  std::ofstream(folder / "cut.png", std::ios::binary) << whole.substr(0, whole.size() / 2);
  std::ofstream(folder / "text.png") << "not a picture";
  std::ofstream(folder / "lost.yaml") << "image: none.png\nresolution: 0.05\norigin: [0, 0, 0]\n";
  std::ofstream(folder / "negative.yaml") << "image: room.png\nresolution: -0.05\norigin: [0, 0, 0]\n";
  std::ofstream(folder / "misspelt.yaml") << "image: room.png\nresolutoin: 0.05\norigin: [0, 0, 0]\n";
  expectRefusal(folder, "simulate none.png", 3, "none.png: no such file");
  expectRefusal(folder, "simulate flatt", 3, "did you mean 'flat'?");
  expectRefusal(folder, "simulate " + folder.path(), 3, "is a folder, expected a file");
  expectRefusal(folder, "simulate cut.png", 3, "cut.png");
  expectRefusal(folder, "simulate text.png", 3, "text.png");
  expectRefusal(folder, "simulate white.png", 3, "no obstacle");
  expectRefusal(folder, "simulate black.png", 3, "no free space");
  expectRefusal(folder, "simulate lost.yaml", 3, "none.png");
  expectRefusal(folder, "simulate negative.yaml", 3, "'resolution'");
  expectRefusal(folder, "simulate misspelt.yaml", 3, "did you mean 'resolution'?");
  expectRefusal(folder, "compare white.png", 3, "no obstacle");
}

TEST(BadInput, BuildingsThatCannotBe) {
  const testing::TempFolder folder;
  std::ofstream(folder / "taken.png") << "a picture of somebody's";
  expectRefusal(folder, "world make hospitl", 3, "did you mean 'hospital'?");
  expectRefusal(folder, "world make office --size 80", 3, "--size: found '80', expected width x height");
  expectRefusal(folder, "world make office --size 80x4", 3, "--size: found '80x4', expected width x height");
  expectRefusal(folder, "world make office --size 80x501", 3,
                "--size: section [building], key 'height_m': found '501', expected a number from 0 to 500");
  expectRefusal(folder, "world make office --size nanx20", 3, "--size: found 'nanx20'");
  expectRefusal(folder, "world make hospital --size 9x7", 3, "found 9 x 7, expected at least ");
  expectRefusal(folder, "world make cave --resolution 0.5", 3,
                "--resolution: section [building], key 'resolution_m': found '0.5'");
  expectRefusal(folder, "world make cave --set building.cluter=0", 3, "did you mean 'clutter'?");
  expectRefusal(folder, "world make cave --set bilding.clutter=0", 3, "did you mean 'building'?");
  expectRefusal(folder, "world make maze --size 20x20", 3, "'maze' has one size and no options");
  expectRefusal(folder, "world make cave -o cave.png", 3, "expected a name that ends with .yaml");
  expectRefusal(folder, "world make cave -o taken.yaml", 3, "taken.png: exists; give --overwrite");
  expectRefusal(folder, "world make cave --preview cave.png", 3, "expected another file");
  expectRefusal(folder, "world make cave --preview taken.png", 3, "taken.png: exists; give --overwrite");
  expectRefusal(folder, "world make cave -o nowhere/cave.yaml", 1, "nowhere/cave");
  expectRefusal(folder, "plot plans taken.png", 3, "taken.png");
}

TEST(BadInput, StartsAndKeysThatCannotBe) {
  const testing::TempFolder folder;
  cv::imwrite(folder / "room.png", roomPicture());
  std::ofstream(folder / "typo.ini") << "[lidar]\nbeams = 90\nmax_rnage_m = 5\n";
  expectRefusal(folder, "simulate room.png --set 'simulation.start=0.02 1 0'", 3, "start");
  expectRefusal(folder, "simulate room.png --set 'simulation.start=-5 1 0'", 3, "start");
  expectRefusal(folder, "simulate room.png --set 'simulation.start=here'", 3,
                "expected auto or x_m,y_m,yaw_deg");
  expectRefusal(folder, "simulate room.png --config typo.ini", 3,
                "typo.ini:3: section [lidar], unknown key 'max_rnage_m'; did you mean 'max_range_m'?");
  expectRefusal(folder, "simulate room.png --set lidar.beams=1", 3,
                "--set: section [lidar], key 'beams': found '1', expected a whole number from 2 to 100000");
  expectRefusal(folder, "simulate room.png --set lidar.beams=0", 3,
                "expected a whole number from 2 to 100000");
  expectRefusal(folder, "simulate room.png --set lidar.fov_deg=361", 3,
                "--set: section [lidar], key 'fov_deg': found '361', expected a number from 1 to 360");
  expectRefusal(folder, "simulate room.png --set lidar.sigma_m=nan", 3,
                "key 'sigma_m': found 'nan', expected a number from 0 to 10");
  expectRefusal(folder, "simulate room.png --set lidar.sweep=-0.1", 3, "key 'sweep': found '-0.1'");
  expectRefusal(folder, "simulate room.png --set lidar.min_range_m=30", 3,
                "section [lidar], key 'min_range_m': found '30', expected less than max_range_m = 30");
  expectRefusal(folder, "simulate room.png --set odometry.wheel_base_m=0", 3,
                "key 'wheel_base_m': found '0', expected a number from 0.01 to 10");
  expectRefusal(folder, "simulate room.png --set odometry.slips_per_m=-1", 3, "key 'slips_per_m'");
  expectRefusal(folder, "simulate room.png --set lidar.beems=1", 3, "did you mean 'beams'?");
  expectRefusal(folder, "simulate room.png --set ladar.beams=9", 3, "did you mean 'lidar'?");
  expectRefusal(folder, "simulate room.png --lidar lms292", 3, "did you mean 'lms291'?");
  expectRefusal(folder, "simulate room.png --strategy quadrat", 3, "did you mean 'quadrant'?");
  expectRefusal(folder, "simulate room.png --set robot.side_m=3", 3, "no free place");
  expectRefusal(folder, "simulate room.png --duration 2 -o /dev/null/run.rawlog", 1, "/dev/null/run.rawlog");
}

TEST(BadInput, MaterialsThatAreNone) {
  const testing::TempFolder folder;
  cv::imwrite(folder / "room.png", roomPicture());
  cv::imwrite(folder / "small.png", cv::Mat(20, 20, CV_8UC1, cv::Scalar(255)));
  cv::Mat painted(40, 60, CV_8UC3, cv::Scalar(255, 255, 255));
  painted.at<cv::Vec3b>(7, 31) = {0, 255, 255};
  cv::imwrite(folder / "yellow.png", painted);
  const auto writeYaml = [&](const std::string& name, const std::string& materials) {
    std::ofstream(folder / name) << "image: room.png\nresolution: 0.05\norigin: [0, 0, 0]\nmaterials: "
                                 << materials << "\n";
  };
  writeYaml("lost.yaml", "none.png");
  writeYaml("small.yaml", "small.png");
  writeYaml("yellow.yaml", "yellow.png");
  writeYaml("none.yaml", "");
  expectRefusal(folder, "simulate lost.yaml", 3,
                "lost.yaml: key 'materials': found 'none.png', which does not");
  expectRefusal(folder, "simulate small.yaml", 3,
                "small.png: the materials have 20 x 20 pixels, expected 60 x 40 as the plan");
  expectRefusal(folder, "simulate yellow.yaml", 3,
                "yellow.png: pixel (31, 7): found colour 255 255 0, expected");
  expectRefusal(folder, "simulate none.yaml", 3,
                "none.yaml:4: key 'materials': found '', expected one value");
}

TEST(BadInput, LogsThatAreNone) {
  const testing::TempFolder folder;
  writeLog(folder / "good.rawlog", 400);
  const std::string whole = files::readTextFile(folder / "good.rawlog");
  std::ofstream(folder / "cut.rawlog", std::ios::binary) << whole.substr(0, whole.size() * 2 / 3);
  std::ofstream(folder / "text.rawlog") << "this is no log\n";
  files::writeFileAtomically(folder / "empty.rawlog", "");
  {
    mrpt::io::CFileGZOutputStream file(folder / "no_scans.rawlog");
    auto archive = mrpt::serialization::archiveFrom(file);
    archive << mrpt::obs::CActionCollection() << mrpt::obs::CSensoryFrame();
    mrpt::io::CFileGZOutputStream thin(folder / "one_beam.rawlog");
    auto thin_archive = mrpt::serialization::archiveFrom(thin);
    auto scan = mrpt::obs::CObservation2DRangeScan::Create();
    scan->resizeScan(1);
    scan->aperture = 1;
    scan->timestamp = mrpt::Clock::fromDouble(1700000000);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(scan);
    thin_archive << mrpt::obs::CActionCollection() << frame;
  }
  for (const std::string command : {"info", "run icp -q", "compare"}) {
    expectRefusal(folder, command + " none.rawlog", 3, "none.rawlog: no such file");
    expectRefusal(folder, command + " " + folder.path(), 3, "is a folder");
    expectRefusal(folder, command + " text.rawlog", 3, "text.rawlog");
    expectRefusal(folder, command + " empty.rawlog", 3, "empty.rawlog");
    expectRefusal(folder, command + " cut.rawlog", 3, "byte");
    expectRefusal(folder, command + " one_beam.rawlog", 3, "1 beam");
  }
  expectRefusal(folder, "run naive no_scans.rawlog -q", 3, "0 laser scans");
  expectRefusal(folder, "compare no_scans.rawlog", 3, "0 laser scans");
}

TEST(BadInput, MethodsAndResultsThatAreNone) {
  const testing::TempFolder folder;
  writeLog(folder / "good.rawlog", 5);
  std::ofstream(folder / "precious.txt") << "x";
  expectRefusal(folder, "run rbfp good.rawlog", 3, "did you mean 'rbpf'?");
  expectRefusal(folder, "run icp good.rawlog --set mapping.resolution_m=-0.05", 3,
                "--set: section [mapping], key 'resolution_m': found '-0.05', expected a number");
  expectRefusal(folder, "run icp good.rawlog --set icp.max_iteration=5", 3, "did you mean 'max_iterations'?");
  expectRefusal(folder, "compare good.rawlog --methods icp,icp", 3, "named twice");
  expectRefusal(folder, "run naive good.rawlog -q -o /dev/null/out", 1, "/dev/null/out");
  expectRefusal(folder, "run naive good.rawlog -q -o .", 3, "exists; give --overwrite");
  expectRefusal(folder, "run naive good.rawlog -q -o . --overwrite", 3, "holds other files");
  expectRefusal(folder, "compare good.rawlog -o . --overwrite", 3, "holds other files");
  expectRefusal(folder, "eval .", 3, "manifest.json: no such file");
  EXPECT_TRUE(fs::exists(folder / "precious.txt"));
}

TEST(BadInput, CommandLinesThatAreNone) {
  const testing::TempFolder folder;
  expectRefusal(folder, "", 2, "'rasterslam --help'");
  expectRefusal(folder, "simulat flat", 2,
                "unknown command 'simulat'; did you mean 'simulate'? (see 'rasterslam --help')");
  expectRefusal(folder, "plot mapp out", 2,
                "unknown command 'mapp'; did you mean 'map'? (see 'rasterslam plot --help')");
  expectRefusal(folder, "simulate flat --sed=3", 2,
                "unknown option '--sed'; did you mean '--seed'? (see 'rasterslam simulate --help')");
  expectRefusal(folder, "run icp", 2, "log");
  expectRefusal(folder, "list colours", 2, "colours");
  expectRefusal(folder, "list world", 2, "did you mean 'worlds'?");
  expectRefusal(folder, "new metod mine", 2, "did you mean 'method'?");
  expectRefusal(folder, "simulate flat --start 2,2", 3, "x_m,y_m,yaw_deg");
  expectRefusal(folder, "simulate flat --seed minus", 2, "minus");
  expectRefusal(folder, "compare flat --threads 0", 2, "--threads");
}

TEST(Help, StandsBeforeACommandToo) {
  const auto before = rasterslam("help plot map"), after = rasterslam("plot map --help");
  EXPECT_EQ(before.exit_code, 0) << before.err;
  EXPECT_EQ(before.out, after.out);
  EXPECT_THAT(before.out, HasSubstr("Usage:"));
}

TEST(Help, FitsIntoATerminal) {
  for (const std::string command : {"", "eval", "bench", "simulate", "filter", "plot map", "run"}) {
    const auto help = rasterslam("help " + command);
    EXPECT_EQ(help.exit_code, 0) << command << help.err;
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);)
      EXPECT_LE(line.size(), 108U) << command << ": " << line;
  }
}

TEST(Help, OfWhatIsNoCommandNamesTheNearest) {
  const auto command = rasterslam("help simulte"), part = rasterslam("help plot erors"),
             more = rasterslam("help info twice");
  for (const auto* refused : {&command, &part, &more}) {
    EXPECT_EQ(refused->exit_code, 2);
    EXPECT_EQ(refused->out, "");
  }
  EXPECT_THAT(command.err, HasSubstr("did you mean 'simulate'?"));
  EXPECT_THAT(part.err, HasSubstr("did you mean 'errors'?"));
}

TEST(BadInput, ALogWithoutOdometryIsMappedFromScansAndSaysSo) {
  const testing::TempFolder folder;
  writeLog(folder / "bare.rawlog", 20, false);
  const auto result = rasterslam("run icp bare.rawlog -o out", folder.path());
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_THAT(result.err, HasSubstr("bare.rawlog: 19 of 19 steps come without odometry"));
  EXPECT_TRUE(fs::exists(folder / "out/map.png"));
}

}  // namespace
}  // namespace slam::apps
