#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libslam/logs/log_reader.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/sim/simulator.h"

namespace slam::run {

/// Tells a method how the scan of the entry was swept, and what other lidars saw with it: before
/// mapping::processScan().
void tellSensors(mapping::MapBuilder& method, const logs::LogEntry& entry);
void tellSensors(mapping::MapBuilder& method, const sim::Sensed& sensed);

/// Scans whose step has no odometry. Of several lidars that take turns, a step has some when any was read
/// since the last scan of the same lidar.
class OdometryGaps {
 public:
  void add(const logs::LogEntry& entry);
  int count() const { return count_; }

 private:
  std::map<std::string, bool> has_odometry_;  ///< by lidar, since its last scan
  int count_ = 0;
};

/// What a manifest says of a method's lidars: `lidars`, `swept_scans` and `deskewed_scans` (these two where
/// some were swept).
void describeSensors(const mapping::MapBuilder& method, const std::vector<std::string>& lidars,
                     std::map<std::string, std::string>& results);

/// How many scans were swept on the move and not deskewed, by describeSensors().
std::uint64_t skewedScans(const std::map<std::string, std::string>& results);

/// A line for people about scans that are skewed and were not deskewed, by describeSensors(); "" where there
/// are none.
std::string skewNote(const std::string& method_name, const std::map<std::string, std::string>& results);

}  // namespace slam::run
