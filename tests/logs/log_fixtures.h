#pragma once
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/serialization/CArchive.h>
#include <zlib.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_reader.h"
#include "libslam/logs/log_writer.h"
#include "libslam/objects/mrpt_time.h"

namespace slam::logs {

inline constexpr double kStart_s = 1'700'000'000.0;

/// A scan of 5 beams over 180 deg, one of each kind of reading among them.
inline lidar::Scan sampleScan(double time_s, float first_range_m) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -core::kPi / 2;
  scan.step_rad = core::kPi / 4;
  scan.max_range_m = 30;
  scan.range_sigma_m = 0.0078125;  // a power of two, so that MRPT's float holds it exactly
  scan.T_robot_lidar = {0.25, -0.125, 0.5};
  scan.ranges_m = {first_range_m, 2.5F, lidar::kNoReturn, lidar::kLostReading, 29.5F};
  return scan;
}

/// A drive in a bent line, 0.2 s between scans.
inline std::vector<LogEntry> sampleEntries(int count) {
  std::vector<LogEntry> entries;
  core::Pose2 T_odom_robot;
  for (int i = 0; i < count; ++i) {
    LogEntry entry;
    if (i > 0) entry.T_previous_robot = {0.1 + 0.01 * i, -0.003 * i, 0.3 - 0.05 * i};
    T_odom_robot = T_odom_robot * entry.T_previous_robot;
    entry.T_odom_robot = T_odom_robot;
    entry.has_odometry = true;
    entry.scan = sampleScan(kStart_s + 0.2 * i, 1.0F + 0.25F * static_cast<float>(i));
    entries.push_back(entry);
  }
  return entries;
}

inline void writeLog(const std::vector<LogEntry>& entries, const std::string& path,
                     rawlogs::RawlogForm form) {
  LogWriter writer(path, form);
  for (const auto& entry : entries) writer.write(entry);
  writer.close();
}

inline std::vector<LogEntry> readLog(const std::string& path, const std::string& label = "") {
  LogReader reader(path, label);
  std::vector<LogEntry> entries;
  while (auto entry = reader.next()) entries.push_back(*entry);
  return entries;
}

/// What came out before the end or the error, and the error's text ("" for a proper end).
struct Outcome {
  size_t entries = 0;
  std::string error;
};
inline Outcome readOutcome(const std::string& path, const std::string& label = "") {
  Outcome outcome;
  try {
    LogReader reader(path, label);
    while (reader.next()) ++outcome.entries;
  } catch (const core::InputError& error) {
    outcome.error = error.what();
  }
  return outcome;
}

inline std::string readBytes(const std::string& path) {
  return files::readTextFile(path);
}

inline void writeBytes(const std::string& bytes, const std::string& path) {
  // Some file systems wait for the disk when an old file is cut to nothing and filled again.
  std::filesystem::remove(path);
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string unpacked(const std::string& path) {
  std::string content;
  char buffer[4096];
  gzFile file = gzopen(path.c_str(), "rb");
  for (int count = 0; (count = gzread(file, buffer, sizeof(buffer))) > 0;)
    content.append(buffer, static_cast<size_t>(count));
  gzclose(file);
  return content;
}

inline mrpt::Clock::time_point mrptTime(double time_s) {
  return mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicks(time_s)));
}

/// Writes any MRPT objects, for logs that our writer would never write.
class RawObjects {
 public:
  explicit RawObjects(const std::string& path) : file_(path) {}
  RawObjects& operator<<(const mrpt::serialization::CSerializable& object) {
    mrpt::serialization::archiveFrom<mrpt::io::CStream>(file_) << object;
    return *this;
  }

 private:
  mrpt::io::CFileGZOutputStream file_;
};

inline mrpt::obs::CObservation2DRangeScan rawScan(double time_s, const std::string& label, int beams = 5) {
  mrpt::obs::CObservation2DRangeScan scan;
  scan.timestamp = time_s > 0 ? mrptTime(time_s) : mrpt::Clock::time_point();
  scan.sensorLabel = label;
  scan.aperture = 1.0F;
  scan.maxRange = 10;
  scan.resizeScan(static_cast<size_t>(beams));
  for (int i = 0; i < beams; ++i) {
    scan.setScanRange(static_cast<size_t>(i), 2.0F);
    scan.setScanRangeValidity(static_cast<size_t>(i), true);
  }
  return scan;
}

inline mrpt::obs::CObservationOdometry rawOdometry(double time_s, double x_m) {
  mrpt::obs::CObservationOdometry odometry;
  odometry.timestamp = time_s > 0 ? mrptTime(time_s) : mrpt::Clock::time_point();
  odometry.sensorLabel = "ODOMETRY";
  odometry.odometry = mrpt::poses::CPose2D(x_m, 0, 0);
  return odometry;
}

inline mrpt::obs::CActionRobotMovement2D wheelAction(double time_s, double x_m) {
  mrpt::obs::CActionRobotMovement2D action;
  action.timestamp = time_s > 0 ? mrptTime(time_s) : mrpt::Clock::time_point();
  action.computeFromOdometry(mrpt::poses::CPose2D(x_m, 0, 0), {});
  return action;
}

template <class... Actions>
mrpt::obs::CActionCollection collection(const Actions&... actions) {
  mrpt::obs::CActionCollection result;
  (result.insert(actions), ...);
  return result;
}

template <class... Observations>
mrpt::obs::CSensoryFrame frame(const Observations&... observations) {
  mrpt::obs::CSensoryFrame result;
  (result.insert(std::make_shared<Observations>(observations)), ...);
  return result;
}

inline mrpt::obs::CObservationComment commentSaying(const std::string& text) {
  mrpt::obs::CObservationComment observation;
  observation.text = text;
  return observation;
}

}  // namespace slam::logs
