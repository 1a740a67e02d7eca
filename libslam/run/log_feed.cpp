#include "libslam/run/log_feed.h"

namespace slam::run {

void tellSensors(mapping::MapBuilder& method, const logs::LogEntry& entry) {
  mapping::setSweep(method, entry.sweep);
  std::vector<mapping::SweptScan> others;
  for (const auto& other : entry.others) others.push_back({other.scan, other.sweep});
  mapping::addScans(method, std::move(others));
}

void tellSensors(mapping::MapBuilder& method, const sim::Sensed& sensed) {
  mapping::setSweep(method, sensed.sweep);
  std::vector<mapping::SweptScan> others;
  for (const auto& other : sensed.others) others.push_back({other.scan, other.sweep});
  mapping::addScans(method, std::move(others));
}

void OdometryGaps::add(const logs::LogEntry& entry) {
  for (auto& [lidar, has_odometry] : has_odometry_) has_odometry |= entry.has_odometry;
  const auto known = has_odometry_.find(entry.lidar);
  if (known != has_odometry_.end() && !known->second) ++count_;
  has_odometry_[entry.lidar] = false;
}

void describeSensors(const mapping::MapBuilder& method, const std::vector<std::string>& lidars,
                     std::map<std::string, std::string>& results) {
  std::string list;
  for (const auto& lidar : lidars) list += (list.empty() ? "" : ",") + lidar;
  results["lidars"] = list;
  const auto scans = mapping::sweptScans(method);
  if (scans.swept == 0) return;
  results["swept_scans"] = std::to_string(scans.swept);
  results["deskewed_scans"] = std::to_string(scans.set_right);
}

std::uint64_t skewedScans(const std::map<std::string, std::string>& results) {
  const auto swept = results.find("swept_scans"), deskewed = results.find("deskewed_scans");
  if (swept == results.end() || deskewed == results.end()) return 0;
  return std::stoull(swept->second) - std::stoull(deskewed->second);
}

std::string skewNote(const std::string& method_name, const std::map<std::string, std::string>& results) {
  const auto skewed = skewedScans(results);
  if (skewed == 0) return "";
  return method_name + ": " + std::to_string(skewed) + " of " + results.at("swept_scans") +
         " scans were swept while the robot moved and were not deskewed";
}

}  // namespace slam::run
