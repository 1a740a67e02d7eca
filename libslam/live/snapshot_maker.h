#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/obstacles/lidar_view.h"
#include "libslam/obstacles/local_obstacle_map.h"
#include "libslam/record/step_observer.h"
#include "libslam/viewer/snapshot.h"

namespace slam::live {

/// Makes snapshots of the steps of a loop. Told of every step; what costs time (the map, the corrected path,
/// the graph) is asked of the method only when a snapshot wants it anew.
class SnapshotMaker {
 public:
  /// T_scene_map: where the map frame lies, when that is known: the true pose at the first scan.
  SnapshotMaker(std::string title, std::string method, const core::Pose2& T_scene_map);

  /// The true path beside a log, in the scene's frame; found by the stamps of the scans.
  void setTruth(core::Trajectory truth) { known_truth_ = std::move(truth); }
  /// Loops that a method closed when the run was made, map frame, and the scan at which it did; in the order
  /// of the scans.
  void setLoops(std::vector<std::pair<int, viewer::Connection>> loops) { known_loops_ = std::move(loops); }

  /// Where someone else than a strategy sends the robot, map frame.
  void setGoal(const core::Point2& goal) { now_.candidates = viewer::Candidates{{}, goal, {}}; }

  /// What the original goal navigation looks at: shown with every scan's readings, robot frame.
  void setStrategicView(double stop_radius_m, std::vector<double> directions_rad);

  void add(const record::Step& step);
  /// Of the step that was added last. `method`: the step's. with_map: its map, path and graph as they are
  /// now, else as they were when they were last asked for.
  viewer::Snapshot snapshot(const mapping::MapBuilder* method, bool with_map);
  double time_s() const { return now_.time_s; }

 private:
  void lookAround(const record::Step& step);
  void followDecision(const record::Step& step);
  void takeTruth(const record::Step& step);
  void lookStrategically(const lidar::Scan& scan);

  viewer::Snapshot now_;  ///< all but what snapshot() asks the method for
  core::Trajectory online_, known_truth_;
  std::vector<std::pair<int, viewer::Connection>> known_loops_;
  obstacles::LocalObstacleOptions zone_;
  obstacles::SectorOptions sector_;
  obstacles::LocalObstacleMap around_;
  std::optional<choices::Decision> decision_;
  core::Pose2 T_map_decided_;  ///< where the robot took it
  std::vector<double> strategic_rad_;
  double collided_at_s_, carried_at_s_;  ///< the last time
  std::size_t carries_ = 0;
};

}  // namespace slam::live
