#include "libslam/results/self_score.h"

#include "libslam/core/error.h"
#include "libslam/logs/read_ahead.h"

namespace slam::results {
namespace {

std::vector<core::Point2> returnsOf(const lidar::Scan& scan) {
  std::vector<core::Point2> returns_lidar;
  returns_lidar.reserve(scan.ranges_m.size());
  for (size_t beam = 0; beam < scan.ranges_m.size(); ++beam) {
    if (!lidar::isReturn(scan.ranges_m[beam])) continue;
    const double range_m = scan.ranges_m[beam], angle_rad = scan.angle(beam);
    returns_lidar.push_back(core::polar(range_m, angle_rad));
  }
  return returns_lidar;
}

}  // namespace

SelfScore selfScore(const std::string& log_path, const core::Trajectory& path, const world::Plan& map,
                    core::Progress& progress, const std::string& lidars, bool reads_ahead) {
  logs::ReadAhead log(log_path, lidars, reads_ahead);
  metrics::PlacedScans scans(map);
  progress.begin("placing the scans");
  size_t scan = 0;
  while (const auto entry = log.next()) {
    if (scan == path.size()) throw core::ContractError("selfScore: more scans than poses");
    scans.add(path[scan].pose * entry->scan.T_robot_lidar, returnsOf(entry->scan));
    for (const auto& other : entry->others)
      scans.add(path[scan].pose * other.scan.T_robot_lidar, returnsOf(other.scan));
    progress.update(log.fractionRead(), path[scan].time_s - path.front().time_s);
    ++scan;
  }
  if (scan != path.size()) throw core::ContractError("selfScore: fewer scans than poses");
  progress.end();
  return {metrics::pointSharpness(scans.points()), scans.agreement()};
}

}  // namespace slam::results
