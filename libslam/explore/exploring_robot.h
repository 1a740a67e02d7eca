#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/explore/exploration_loop.h"
#include "libslam/explore/exploration_referee.h"
#include "libslam/explore/exploration_tables.h"
#include "libslam/explore/loop_localiser.h"
#include "libslam/navigate/driver.h"
#include "libslam/record/recorder.h"
#include "libslam/results/stopped_run.h"

namespace slam::explore {

/// One robot of a closed loop: its body and sensors in the simulator, the method that makes its map, the
/// driver with its strategy, and what the truth has to say of it. The loop, of one robot or of several, calls
/// begin() once, then for every scan locate(), decide() and carryOut(), and in the end end(), result() and
/// writeFiles().
///
/// Keeps references to plan, config and method. A folder that is not "" gets the run's files, see explore().
class ExploringRobot {
 public:
  struct Place {
    core::Pose2 T_world_start;
    metrics::ExplorableArea area;  ///< what its coverage is counted against
  };
  ExploringRobot(const world::Plan& plan, const ExploreConfig& config, const LoopMethod& method,
                 std::uint64_t seed, Place place, const std::string& folder);

  /// The first look.
  void begin();
  /// Gives the newest scan to the method and to the scores. MethodError when the method fails.
  void locate();
  /// Whether decide() will look at a map.
  bool wantsMap() const { return driver_->wantsMap(); }
  /// What the driver wants to do by the newest scan and, where it wants one, by the map: its own method's
  /// unless another one is given.
  robot::Command decide(const gridmap::OccupancyRaster* map = nullptr);
  /// In place of decide() where something else drives the robot.
  void watch();
  void show(record::StepObserver& observer) const;
  /// Drives, looks and records.
  void carryOut(const robot::Command& command);
  /// The two halves of it: all robots drive before any looks.
  void drive(const robot::Command& command);
  void look(const robot::Command& command);
  /// Beams that end on these discs (robot frame) count as lost from now on: other robots are no part of the
  /// map. What is recorded keeps them.
  void leaveOut(const std::vector<movers::Disc>& discs_robot);

  /// From now on it drives back to its start.
  void startReturn();
  bool isReturning() const { return returning_; }
  /// The first end counts: what happens on the way back is no part of the exploration.
  void end(ExplorationEnd end);
  /// The method has failed on the way; what it had mapped stays.
  void fail(const core::MethodError& error);
  bool hasLocated() const { return !estimate_.empty(); }

  LoopResult result() const;
  void writeFiles(LoopResult& result, resources::Manifest manifest);

  double elapsed_s() const;  ///< since the first scan
  double period_s() const { return 1 / config_.record.lidar.rate_hz; }
  double radius_m() const { return radius_m_; }
  double path_m() const { return path_.length_m(); }
  const core::Pose2& start() const { return start_; }
  const core::Pose2& truth() const { return simulator_.truth(); }
  const core::Pose2& estimate() const { return T_map_robot_; }
  const core::Trajectory& trueTrajectory() const { return truth_; }
  const core::Trajectory& estimatedTrajectory() const { return estimate_; }
  const sim::Sensed& sensed() const { return sensed_; }
  const metrics::Coverage& coverage() const { return coverage_; }
  sim::Simulator& simulator() { return simulator_; }
  const sim::Simulator& simulator() const { return simulator_; }
  navigate::Driver& driver() { return *driver_; }
  const navigate::Driver& driver() const { return *driver_; }
  gridmap::OccupancyRaster map() const { return localiser_.map(); }

 private:
  std::unique_ptr<navigate::Driver> makeDriver() const;
  table::Table explorationTable() const;
  bool writeMap(const Exploration& e);
  void drawPath(const Exploration& e) const;
  void describeResults(const Exploration& e, bool has_map, resources::Manifest& manifest) const;
  void score(Exploration& e) const;

  const world::Plan& plan_;
  const ExploreConfig& config_;
  const LoopMethod& method_;
  std::uint64_t seed_;
  std::string folder_;
  core::Pose2 start_;
  double radius_m_;
  sim::Simulator simulator_;
  Localiser localiser_;
  double decisions_ms_ = 0, slowest_decision_ms_ = 0;  ///< CPU time, the map's reading included
  std::unique_ptr<navigate::Driver> driver_;
  metrics::Coverage coverage_;
  NearMisses near_misses_;
  std::optional<record::Recorder> recorder_;

  sim::Sensed sensed_;
  core::Pose2 T_map_robot_;
  std::optional<lidar::Scan> first_scan_, last_scan_;
  core::Trajectory truth_, estimate_;
  std::vector<metrics::CoveragePoint> curve_;
  std::vector<core::Point2> goals_;  ///< after every scan, map frame; none for the last when it ended there
  std::vector<DecisionEntry> decisions_;
  sim::DrivenPath path_;
  bool saw_something_ = false;
  bool returning_ = false;
  ExplorationEnd end_ = ExplorationEnd::kFailed;
  std::string end_detail_;
  std::size_t explored_scans_ = 0;  ///< what follows is the way back
  double start_time_s_ = 0;
  std::optional<results::Stop> stop_;
};

}  // namespace slam::explore
