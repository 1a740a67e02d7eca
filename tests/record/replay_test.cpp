#include <gtest/gtest.h>

#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/record/record.h"
#include "libslam/resources/resources.h"
#include "libslam/sim/operation_log.h"
#include "libslam/testing/temp_folder.h"

namespace slam::record {
namespace {

/// The original odometry over the scans of a log, told of every command what it was, from where to where.
core::Trajectory originalDeadReckoning(const std::string& log_path,
                                       const std::vector<robot::Commanded>& commands) {
  odometry::ScanOdometryOptions options;
  options.method = "argmax";
  const auto odometry = odometry::makeScanOdometry(options);
  logs::LogReader log(log_path);
  core::Trajectory path;
  while (const auto entry = log.next()) {
    if (path.empty()) {
      odometry->update(entry->scan);
      path.push_back({0, {}});
      continue;
    }
    const auto motion = odometry->update(entry->scan, commands.at(path.size()));
    path.push_back({static_cast<double>(path.size()), path.back().pose * motion.T_previous_current});
  }
  return path;
}

/// The operation log says all that the original dead reckoning does, for a lidar that looks back (two
/// readings of every move) and one that does not, and one whose beams end without a return.
TEST(ReplayOperations, GivesThePathOfTheOriginalDeadReckoningOnTheSameLog) {
  const auto plan = world::loadPlan(resources::resolvePlan("flat"));
  struct Lidar {
    const char *fov_deg, *max_range_m, *drop_out;
  };
  for (const Lidar& lidar : {Lidar{"360", "30", "0"}, {"180", "30", "0"}, {"360", "1.5", "0.05"}}) {
    const testing::TempFolder folder;
    files::IniFile ini;
    ini.set("simulation", "duration_s", "60", "test");
    ini.set("lidar", "beams", "180", "test");
    ini.set("lidar", "fov_deg", lidar.fov_deg, "test");
    ini.set("lidar", "max_range_m", lidar.max_range_m, "test");
    ini.set("lidar", "drop_out", lidar.drop_out, "test");
    const std::string log_path = folder / "run.rawlog", operations_path = folder / "run.operations.txt";
    record(plan, readRecordConfig(ini), 5, log_path, {}, core::silentProgress());
    const auto operations = sim::parseOperations(files::readTextFile(operations_path), operations_path);
    const auto replayed = sim::replayOperations(operations);
    const auto scans = logs::inspectLog(log_path).scans;
    const auto every_scan =
        originalDeadReckoning(log_path, sim::commandsOfScans(operations, scans, operations_path));
    ASSERT_EQ(every_scan.size(), scans);
    core::Trajectory reckoned = {every_scan.front()};
    for (const auto& operation : operations) reckoned.push_back(every_scan.at(operation.scan_after));
    ASSERT_EQ(replayed.size(), reckoned.size());
    EXPECT_LT(operations.size(), scans / 2) << "an operation is a whole command, not a scan";
    EXPECT_GT(core::pathLength(replayed), 1);
    for (size_t i = 0; i < replayed.size(); ++i) {
      // The log holds the scan's step as MRPT's float aperture, so turns differ in the 7th digit.
      ASSERT_NEAR(replayed[i].pose.x, reckoned[i].pose.x, 1e-4) << lidar.fov_deg << " deg, pose " << i;
      ASSERT_NEAR(replayed[i].pose.y, reckoned[i].pose.y, 1e-4) << lidar.fov_deg << " deg, pose " << i;
      ASSERT_NEAR(core::angleDifference(replayed[i].pose.phi, reckoned[i].pose.phi), 0, 1e-5);
    }
  }
}

}  // namespace
}  // namespace slam::record
