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

/// Scans one after the other at the poses of a path.
class Placing {
 public:
  Placing(const core::Trajectory& path, const world::CellMap& map, core::Progress& progress)
      : path_(path), scans_(map), progress_(progress) {
    progress_.begin("placing the scans");
  }

  /// The next pose is that of the scans to come.
  void begin() {
    if (at_ == path_.size()) throw core::ContractError("selfScore: more scans than poses");
    ++at_;
  }
  void add(const lidar::Scan& scan) { scans_.add(path_[at_ - 1].pose * scan.T_robot_lidar, returnsOf(scan)); }
  void update(double fraction) { progress_.update(fraction, path_[at_ - 1].time_s - path_.front().time_s); }
  SelfScore score() {
    if (at_ != path_.size()) throw core::ContractError("selfScore: fewer scans than poses");
    progress_.end();
    return {metrics::pointSharpness(scans_.takePoints()), scans_.agreement()};
  }

 private:
  const core::Trajectory& path_;
  metrics::PlacedScans scans_;
  core::Progress& progress_;
  size_t at_ = 0;
};

}  // namespace

SelfScore selfScore(logs::KeptScans& kept, const core::Trajectory& path, const world::CellMap& map,
                    core::Progress& progress) {
  Placing placing(path, map, progress);
  for (size_t entry = 0; const auto scans = kept.next(); ++entry) {
    placing.begin();
    for (const auto& scan : *scans) placing.add(scan);
    placing.update(static_cast<double>(entry + 1) / static_cast<double>(path.size()));
  }
  return placing.score();
}

SelfScore selfScore(const std::string& log_path, const core::Trajectory& path, const world::CellMap& map,
                    core::Progress& progress, const std::string& lidars, bool reads_ahead) {
  logs::ReadAhead log(log_path, lidars, reads_ahead);
  Placing placing(path, map, progress);
  while (const auto entry = log.next()) {
    placing.begin();
    placing.add(entry->scan);
    for (const auto& other : entry->others) placing.add(other.scan);
    placing.update(log.fractionRead());
  }
  return placing.score();
}

}  // namespace slam::results
