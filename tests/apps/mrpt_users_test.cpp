// What docs/mrpt.md promises to users of MRPT, run as they would.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <sstream>

#include "libslam/files/files.h"
#include "libslam/logs/log_writer.h"
#include "tests/apps/program.h"
#include "tests/mapping/small_room.h"

namespace slam::apps {
namespace {
namespace fs = std::filesystem;
using ::testing::HasSubstr;

const std::string kSource = RASTERSLAM_SOURCE_DIR;

/// A drive with exact scans and no odometry, as from a lidar in somebody's hand.
mapping::test::Drive writeScansAlone(const std::string& path) {
  auto drive = mapping::test::driveThroughRoom();
  logs::LogWriter writer(path, rawlogs::RawlogForm::kObservationOnly);
  for (auto entry : drive.entries) {
    entry.has_odometry = false;
    writer.write(entry);
  }
  writer.close();
  return drive;
}

/// x, y and heading in the last line of a path of MRPT's programs.
core::Pose2 endOfPath(const std::string& path, size_t yaw_field) {
  std::istringstream lines(files::readTextFile(path));
  std::string last;
  for (std::string line; std::getline(lines, line);)
    if (line.find_first_of("0123456789") != std::string::npos) last = line;
  std::istringstream numbers(last);
  std::vector<double> values;
  for (double value = 0; numbers >> value;) values.push_back(value);
  return values.size() > yaw_field ? core::Pose2{values[1], values[2], values[yaw_field]}
                                   : core::Pose2{NAN, NAN, NAN};
}

TEST(StockProgramsWithOurOdometry, MapALogThatHadNone) {
  for (const std::string program : {"icp-slam", "rbpf-slam"})
    if (!testing::programExists(program))
      GTEST_SKIP() << program << " (Debian package mrpt-apps) is not installed";
  const testing::TempFolder folder;
  const auto drive = writeScansAlone(folder / "scans.rawlog");
  for (const std::string odometry : {"correlation", "range_flow", "plicp"}) {
    const auto filtered = rasterslam(
        "filter scans.rawlog --odometry " + odometry + " --form action -o run.rawlog --overwrite -q",
        folder.path());
    ASSERT_EQ(filtered.exit_code, 0) << filtered.err;
    for (const auto& [program, yaw_field] :
         {std::pair<std::string, size_t>{"icp-slam", 3}, {"rbpf-slam", 4}}) {
      const auto run = testing::runCommand(
          "cd '" + folder.path() + "' && env -u DISPLAY LD_PRELOAD='" RASTERSLAM_FIXED_DRAWS "' " + program +
          " '" + kSource + "/configs/mrpt/" + program + ".ini' run.rawlog");
      ASSERT_EQ(run.exit_code, 0) << run.out << run.err;
      const auto end =
          endOfPath(folder / ("LOG_rasterslam_" + program + "/log_estimated_path.txt"), yaw_field);
      // rbpf-slam's own grid is turned by half a step of the lidar.
      EXPECT_LT(core::distance(end, drive.truth.back()), 0.12) << program << " " << odometry;
    }
  }
}

TEST(StockProgramsWithOurOdometry, TellApartALogWithoutOdometryWhichRbpfSlamDoesNotMap) {
  if (!testing::programExists("rbpf-slam"))
    GTEST_SKIP() << "rbpf-slam (Debian package mrpt-apps) is not installed";
  const testing::TempFolder folder;
  writeScansAlone(folder / "scans.rawlog");
  ASSERT_EQ(rasterslam("convert scans.rawlog frames.rawlog --form action -q", folder.path()).exit_code, 0);
  const auto run = testing::runCommand("cd '" + folder.path() + "' && env -u DISPLAY rbpf-slam '" + kSource +
                                       "/configs/mrpt/rbpf-slam.ini' frames.rawlog");
  EXPECT_THAT(run.out + run.err, HasSubstr("act2D"))
      << "it asks for an action; if not, docs/mrpt.md is out of date";
}

TEST(TheExample, ExploresAWorldWithMrptsOwnSlamAndIsTheOneInTheDocuments) {
  const std::string code = files::readTextFile(kSource + "/apps/examples/explore_with_mrpt.cpp");
  EXPECT_LE(std::count(code.begin(), code.end(), '\n'), 42);
  EXPECT_THAT(files::readTextFile(kSource + "/docs/mrpt.md"), HasSubstr("```cpp\n" + code + "```\n"));
  const testing::TempFolder folder;
  const auto run = testing::runCommand("cd '" + folder.path() + "' && '" RASTERSLAM_EXAMPLE "'");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("explored: no frontier of 0.30 m left in reach"));
  EXPECT_GT(fs::file_size(folder / "map.png"), 3000U);
}

// Each row of the two tables of components ends with `tests/room/file_test.cpp`: `Name` |
TEST(TheDocumentForMrptsUsers, NamesATestThatThereIsInEachRow) {
  std::istringstream lines(files::readTextFile(kSource + "/docs/mrpt.md"));
  static const std::regex kTest(R"re(`(tests/[^`]+)`: `([^`]+)` \|$)re");
  int rows = 0;
  bool in_components = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind('|', 0) != 0) in_components = false;
    if (line.rfind("|---", 0) != 0 && in_components) {
      std::smatch test;
      ASSERT_TRUE(std::regex_search(line, test, kTest)) << line;
      EXPECT_THAT(files::readTextFile(kSource + "/" + std::string(test[1])),
                  HasSubstr(", " + std::string(test[2]) + ")"));
      ++rows;
    }
    in_components = in_components || line.rfind("| component |", 0) == 0;
  }
  EXPECT_GE(rows, 15);
}

}  // namespace
}  // namespace slam::apps
