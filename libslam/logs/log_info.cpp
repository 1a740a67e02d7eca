#include <algorithm>
#include <filesystem>
#include <limits>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/middle_value.h"
#include "libslam/logs/log_reader.h"

namespace slam::logs {
namespace {

double fieldOfView(const lidar::Scan& scan) {
  return static_cast<double>(scan.ranges_m.size() - 1) * scan.step_rad;
}

void takeGeometry(const lidar::Scan& scan, LogInfo& info) {
  info.beams = static_cast<int>(scan.ranges_m.size());
  info.fov_rad = fieldOfView(scan);
  info.step_rad = scan.step_rad;
  info.max_range_m = scan.max_range_m;
  info.T_robot_lidar = scan.T_robot_lidar;
}

bool hasGeometry(const lidar::Scan& scan, const LogInfo& info) {
  return static_cast<int>(scan.ranges_m.size()) == info.beams && scan.step_rad == info.step_rad &&
         scan.max_range_m == info.max_range_m && scan.T_robot_lidar == info.T_robot_lidar;
}

std::string formOf(const LogCounts& counts) {
  if (counts.has_frames) return counts.has_bare_observations ? "mixed" : "action / sensory frame";
  return counts.entries > 0 ? "observation only" : "empty";
}

}  // namespace

LogInfo inspectLog(const std::string& path) {
  LogReader reader(path);
  LogInfo info;
  info.path = path;
  info.first_time_s = std::numeric_limits<double>::infinity();
  info.last_time_s = -std::numeric_limits<double>::infinity();
  std::vector<double> periods_s;
  double previous_time_s = 0;
  std::uint64_t readings = 0, no_returns = 0, lost = 0;
  while (const auto entry = reader.next()) {
    const auto& scan = entry->scan;
    if (info.scans == 0)
      takeGeometry(scan, info);
    else
      periods_s.push_back(scan.time_s - previous_time_s);
    ++info.scans;
    previous_time_s = scan.time_s;
    info.first_time_s = std::min(info.first_time_s, scan.time_s);
    info.last_time_s = std::max(info.last_time_s, scan.time_s);
    info.geometry_varies |= !hasGeometry(scan, info);
    info.odometry_length_m += core::hypot(entry->T_previous_robot.x, entry->T_previous_robot.y);
    readings += scan.ranges_m.size();
    for (const float range_m : scan.ranges_m) {
      no_returns += range_m == lidar::kNoReturn;
      lost += std::isnan(range_m);
    }
  }
  if (info.scans == 0) info.first_time_s = info.last_time_s = 0;
  if (!periods_s.empty()) {
    info.longest_gap_s = std::max(0.0, *std::max_element(periods_s.begin(), periods_s.end()));
    info.stamps_run_back = *std::min_element(periods_s.begin(), periods_s.end()) < 0;
  }
  info.median_scan_period_s = core::middleValue(std::move(periods_s));
  if (readings > 0) {
    info.no_return_share = static_cast<double>(no_returns) / static_cast<double>(readings);
    info.lost_share = static_cast<double>(lost) / static_cast<double>(readings);
  }
  const auto& counts = reader.counts();
  info.form = formOf(counts);
  info.file_bytes = std::filesystem::file_size(path);
  info.entries = counts.entries;
  info.odometry_readings = counts.odometry_readings;
  info.other_observations = counts.other_observations;
  info.scans_by_label = counts.scans_by_label;
  info.sensor_label = reader.sensorLabel();
  info.remarks = reader.remarks();
  return info;
}

void requireUsable(const LogInfo& info) {
  if (info.scans == 0) throw core::InputError(info.path + ": holds 0 laser scans, expected at least 1");
  if (info.beams < 2)
    throw core::InputError(info.path + ": holds laser scans of " + std::to_string(info.beams) +
                           (info.beams == 1 ? " beam" : " beams") + ", expected at least 2");
}

}  // namespace slam::logs
