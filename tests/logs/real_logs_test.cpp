// Every real and simulated CARMEN log beside the project, against a reading of its lines that shares nothing
// with the library's.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "libslam/edit/convert.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/objects/mrpt_time.h"
#include "tests/logs/carmen_fixtures.h"

namespace slam::logs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;

const std::string kSource = RASTERSLAM_SOURCE_DIR;

/// What the lines do not say of a log, or say in their own way: as its providers describe it.
struct RealLog {
  std::string name, unpack, file;
  size_t scans, odometry_lines;
  double first_deg, step_deg, no_return_m, lidar_x_m;
};
const RealLog kIntel{"intel", "bzcat", "logs/intel/intel.clf.bz2", 13631, 26915, -90, 1, 80, 0};
const RealLog kFr079{"fr079", "bzcat", "logs/fr079/fr079.clf.bz2", 4934, 8951, -90, 0.5, 80, -0.04};
const RealLog kKillian{
    "killian", "xzcat", "logs/mit-killian/mit-killian.reconstructed.clf.xz", 17480, 0, -90, 1, 51, 0};
const RealLog kRingA{"ring_A", "xzcat", "sim/ring_A.clf.xz", 2082, 0, -90, 0.5, 30, 0};
const RealLog kRingB{"ring_B", "xzcat", "sim/ring_B.clf.xz", 2082, 0, -90, 1, 12, 0};

/// The path of the log, or "" where it is absent.
std::string pathOf(const RealLog& log) {
  const std::string data = testing::realDataFolder(kSource);
  const std::string path = data + "/" + log.file;
  return !data.empty() && std::filesystem::exists(path) ? path : "";
}

#define SKIP_WITHOUT(log, path)         \
  const std::string path = pathOf(log); \
  if ((path).empty()) GTEST_SKIP() << (log).file << " is not beside the project (../shared/data)"

std::vector<std::string> linesOf(const std::string& command) {
  std::vector<std::string> lines;
  FILE* pipe = popen(command.c_str(), "r");
  char* buffer = nullptr;
  size_t size = 0;
  for (ssize_t length; (length = getline(&buffer, &size, pipe)) > 0;) {
    std::string line(buffer, static_cast<size_t>(length));
    if (line.back() == '\n') line.pop_back();
    lines.push_back(line);
  }
  std::free(buffer);
  pclose(pipe);
  return lines;
}

std::vector<std::string> wordsOf(const std::string& line) {
  std::istringstream stream(line);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

double number(const std::string& word) {
  return std::strtod(word.c_str(), nullptr);
}

/// A line of measurements, by the places of its fields.
struct SourceLine {
  std::string kind;
  std::vector<double> ranges_m;
  double x, y, theta, time_s;  ///< odometry
};
bool parseLine(const std::string& line, SourceLine& parsed) {
  const auto w = wordsOf(line);
  if (w.empty() || (w[0] != "ODOM" && w[0] != "FLASER" && w[0] != "ROBOTLASER1")) return false;
  parsed.kind = w[0];
  parsed.ranges_m.clear();
  size_t at = 1, count = 0;
  if (w[0] == "FLASER") count = std::stoul(w[1]), at = 2;
  if (w[0] == "ROBOTLASER1") count = std::stoul(w[8]), at = 9;
  for (size_t i = 0; i < count; ++i) parsed.ranges_m.push_back(number(w[at + i]));
  at += count;
  if (w[0] == "ROBOTLASER1") at += 1 + std::stoul(w[at]);
  if (w[0] != "ODOM") at += 3;  // the laser's pose
  parsed.x = number(w[at]), parsed.y = number(w[at + 1]), parsed.theta = number(w[at + 2]);
  at += w[0] == "FLASER" ? 3 : w[0] == "ODOM" ? 6 : 8;
  parsed.time_s = number(w[at]);
  return true;
}

/// MRPT's own reader.
class MrptReader {
 public:
  explicit MrptReader(const std::string& path) : file_(path) {}
  /// The next observation that is no comment.
  mrpt::obs::CObservation::Ptr next() {
    for (;;) {
      auto object = mrpt::serialization::archiveFrom(file_).ReadObject();
      if (std::dynamic_pointer_cast<mrpt::obs::CObservationComment>(object)) continue;
      return std::dynamic_pointer_cast<mrpt::obs::CObservation>(object);
    }
  }

 private:
  mrpt::io::CFileGZInputStream file_;
};

double secondsOf(const mrpt::obs::CObservation& observation) {
  return objects::secondsFromMrptTicks(observation.timestamp.time_since_epoch().count());
}

// MRPT counts in steps of 1e-7 s, which is coarser than a double for fr079's clock, that started with the
// computer.
constexpr double kHalfTick_s = 0.51e-7;

void expectOdometry(const SourceLine& line, const CObservationOdometry& odometry) {
  ASSERT_NEAR(secondsOf(odometry), line.time_s, kHalfTick_s);
  ASSERT_EQ(odometry.odometry.x(), line.x);
  ASSERT_EQ(odometry.odometry.y(), line.y);
  ASSERT_EQ(odometry.odometry.phi(), line.theta);
}

void expectScan(const RealLog& log, const SourceLine& line, const CObservation2DRangeScan& scan) {
  ASSERT_NEAR(secondsOf(scan), line.time_s, kHalfTick_s);
  ASSERT_EQ(scan.sensorLabel, line.kind);
  ASSERT_EQ(scan.getScanSize(), line.ranges_m.size());
  ASSERT_EQ(scan.sensorPose.x(), log.lidar_x_m);
  ASSERT_EQ(scan.sensorPose.y(), 0);
  for (size_t i = 0; i < line.ranges_m.size(); ++i) {
    ASSERT_EQ(scan.getScanRange(i), static_cast<float>(line.ranges_m[i]));
    ASSERT_EQ(scan.getScanRangeValidity(i), line.ranges_m[i] < log.no_return_m && line.ranges_m[i] > 0);
  }
  for (const size_t i : {size_t{0}, line.ranges_m.size() / 3, line.ranges_m.size() - 1})
    // MRPT keeps the aperture in a float: 3 rad have steps of 2.4e-7 rad.
    ASSERT_NEAR(scan.sensorPose.yaw() + static_cast<double>(scan.getScanAngle(i)),
                core::degToRad(log.first_deg + log.step_deg * static_cast<double>(i)), 1e-6);
}

/// Word by word; where text differs, as numbers. The fields that may differ: logger_timestamp, the last; the
/// laser pose, by the rounding of the sixth decimal, as it is made from odometry and mounting.
void expectSameLine(const std::string& source, const std::string& back, size_t& other_text) {
  const auto a = wordsOf(source), b = wordsOf(back);
  ASSERT_EQ(a.size(), b.size()) << source;
  const bool is_message = a[0] == "ODOM" || a[0] == "FLASER" || a[0] == "ROBOTLASER1";
  size_t laser_pose = a.size();
  if (a[0] == "FLASER") laser_pose = a.size() - 9;
  if (a[0] == "ROBOTLASER1") laser_pose = a.size() - 14;
  for (size_t i = 0; i < a.size(); ++i) {
    if (a[i] == b[i] || (is_message && i + 1 == a.size())) continue;
    const bool is_laser_pose = i >= laser_pose && i < laser_pose + 3;
    ASSERT_TRUE(is_message) << source;
    ASSERT_NEAR(number(a[i]), number(b[i]), is_laser_pose ? 2.5e-6 : 0) << "word " << i << " of " << source;
    if (!is_laser_pose) ++other_text;
  }
}

class EveryLog : public ::testing::TestWithParam<RealLog> {};
INSTANTIATE_TEST_SUITE_P(Real, EveryLog, ::testing::Values(kIntel, kFr079, kKillian, kRingA, kRingB),
                         [](const auto& log) { return log.param.name; });

TEST_P(EveryLog, BecomesARawlogThatEqualsItAndComesBack) {
  const RealLog& log = GetParam();
  SKIP_WITHOUT(log, path);
  const testing::TempFolder folder;
  const auto report = edit::convertLog(path, folder / "a.rawlog", {}, core::silentProgress());
  EXPECT_EQ(report.from, LogFormat::kCarmen);
  EXPECT_EQ(report.skipped, "");
  const auto source = linesOf(log.unpack + " '" + path + "'");
  MrptReader rawlog(folder / "a.rawlog");
  size_t scans = 0, odometry_lines = 0;
  SourceLine line;
  for (const auto& text : source) {
    if (!parseLine(text, line)) continue;
    SCOPED_TRACE(text.substr(0, 60));
    const auto odometry = std::dynamic_pointer_cast<CObservationOdometry>(rawlog.next());
    ASSERT_TRUE(odometry);
    expectOdometry(line, *odometry);
    ASSERT_EQ(odometry->sensorLabel, line.kind == "ODOM" ? "ODOMETRY" : line.kind + "_ODOMETRY");
    if (line.kind == "ODOM") {
      ++odometry_lines;
      continue;
    }
    const auto scan = std::dynamic_pointer_cast<CObservation2DRangeScan>(rawlog.next());
    ASSERT_TRUE(scan);
    expectScan(log, line, *scan);
    if (HasFatalFailure()) return;
    ++scans;
  }
  EXPECT_EQ(scans, log.scans);
  EXPECT_EQ(odometry_lines, log.odometry_lines);

  edit::LogConversion to_carmen;
  to_carmen.to = LogFormat::kCarmen;
  edit::convertLog(folder / "a.rawlog", folder / "b.clf", to_carmen, core::silentProgress());
  const auto back = linesOf("cat '" + (folder / "b.clf") + "'");
  ASSERT_EQ(back.size(), source.size());
  size_t other_text = 0;  // equal numbers, other zeros
  for (size_t i = 0; i < source.size(); ++i) {
    ASSERT_NO_FATAL_FAILURE(expectSameLine(source[i], back[i], other_text));
  }
  const bool is_simulated = log.name.find("ring") == 0;  // it writes zeros shorter
  EXPECT_TRUE(is_simulated || other_text == 0);
  // This log's logger_timestamps are counted from its first stamp, so nothing at all is lost.
  EXPECT_TRUE(log.name != "intel" || source == back);
}

// --- Oddities ----------------------------------------------------------------------------------------------

TEST(RealLogs, KeepTheOrderOfTheFileWhereStampsRunBack) {
  SKIP_WITHOUT(kIntel, path);
  const auto source = linesOf("bzcat '" + path + "' | grep ^FLASER");
  LogReader reader(path);
  size_t i = 0, back = 0;
  double before_s = 0;
  SourceLine line;
  core::Pose2 first;
  while (const auto entry = reader.next()) {
    ASSERT_TRUE(parseLine(source[i], line));
    ASSERT_EQ(entry->scan.time_s, line.time_s);
    ASSERT_TRUE(entry->has_odometry) << "a scan has the odometry of its own line";
    const core::Pose2 odometry{line.x, line.y, line.theta};
    if (i == 0) first = odometry;
    const auto expected = core::between(first, odometry);
    // Increments composed over up to 40 000 readings, rounded to a double each.
    ASSERT_NEAR(entry->T_odom_robot.x, expected.x, 1e-6) << i;
    ASSERT_NEAR(entry->T_odom_robot.y, expected.y, 1e-6) << i;
    back += entry->scan.time_s < before_s ? 1 : 0;
    before_s = entry->scan.time_s;
    ++i;
  }
  EXPECT_EQ(i, kIntel.scans);
  EXPECT_EQ(back, 631U);
}

TEST(RealLogs, MountTheLidarOfFr079BehindTheCentre) {
  SKIP_WITHOUT(kFr079, path);
  const auto entry = LogReader(path).next();
  EXPECT_EQ(entry->scan.T_robot_lidar.x, -0.04);
  // What the readings are taken from is 4 cm further back than the robot's centre.
  const auto points = lidar::scanPoints(entry->scan);
  const double range_m = static_cast<double>(entry->scan.ranges_m[0]);
  EXPECT_NEAR(points[0].x, -0.04, 1e-6) << "the first beam points to the right";
  EXPECT_NEAR(points[0].y, -range_m, 1e-6);
}

TEST(RealLogs, SayWhichStampsOfMitKillianAreInterpolated) {
  SKIP_WITHOUT(kKillian, path);
  const auto source = openLog(path);
  std::string host;
  std::map<std::string, size_t> scans;
  const std::string note = "CARMEN note: host ";
  while (const auto object = source->next()) {
    const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(object.get());
    if (comment && comment->text.compare(0, note.size(), note) == 0) host = comment->text.substr(note.size());
    if (dynamic_cast<const CObservation2DRangeScan*>(object.get())) ++scans[host];
  }
  EXPECT_EQ(scans["nohost"], 3838U);
  EXPECT_EQ(scans["interpolated"], 13642U);
}

// --- MRPT's programs ---------------------------------------------------------------------------------------

constexpr size_t kScansForPrograms = 300;

/// The beginning of a log in one of the forms.
void writeStart(const std::string& path, rawlogs::RawlogForm form, const std::string& out,
                size_t most_scans) {
  const auto source = rawlogs::inForm(openLog(path), form, path);
  const auto sink = createLog(out, LogFormat::kRawlog);
  for (size_t scans = 0; scans < most_scans;) {
    const auto object = source->next();
    if (!object) break;
    sink->write(*object);
    const bool is_frame = dynamic_cast<const mrpt::obs::CSensoryFrame*>(object.get()) != nullptr;
    if (is_frame || dynamic_cast<const CObservation2DRangeScan*>(object.get())) ++scans;
  }
  sink->close();
}

size_t linesIn(const std::string& path) {
  const std::string text = files::readTextFile(path);
  return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST_P(EveryLog, IsMappedByStockIcpSlam) {
  const RealLog& log = GetParam();
  SKIP_WITHOUT(log, path);
  if (!testing::programExists("icp-slam"))
    GTEST_SKIP() << "icp-slam (Debian package mrpt-apps) is not installed";
  const testing::TempFolder folder;
  writeStart(path, rawlogs::RawlogForm::kObservationOnly, folder / "a.rawlog", kScansForPrograms);
  const auto run = testing::runCommand("cd '" + folder.path() + "' && env -u DISPLAY icp-slam '" + kSource +
                                       "/configs/mrpt/icp-slam.ini' a.rawlog");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_GE(linesIn(folder / "LOG_rasterslam_icp-slam/log_estimated_path.txt"), kScansForPrograms);
}

TEST_P(EveryLog, IsMappedByStockRbpfSlamInTheActionForm) {
  const RealLog& log = GetParam();
  SKIP_WITHOUT(log, path);
  if (!testing::programExists("rbpf-slam"))
    GTEST_SKIP() << "rbpf-slam (Debian package mrpt-apps) is not installed";
  const testing::TempFolder folder;
  constexpr size_t kScans = 60;
  writeStart(path, rawlogs::RawlogForm::kActionFrame, folder / "a.rawlog", kScans);
  const auto run = testing::runCommand("cd '" + folder.path() + "' && env -u DISPLAY rbpf-slam '" + kSource +
                                       "/configs/mrpt/rbpf-slam.ini' a.rawlog");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_EQ(linesIn(folder / "LOG_rasterslam_rbpf-slam/log_estimated_path.txt"), kScans);
}

}  // namespace
}  // namespace slam::logs
