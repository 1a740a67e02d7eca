#pragma once
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/sim/simulator.h"
#include "libslam/strategies/strategy.h"

namespace slam::record {

/// What a loop has after a step: after a scan was taken in, before the next command. Valid during the call
/// only.
struct Step {
  double time_s;                                ///< since the first scan
  const lidar::Scan& scan;                      ///< the new one
  core::Pose2 T_previous_robot;                 ///< odometry's increment since the scan before
  core::Pose2 T_map_robot;                      ///< the estimate; without a method odometry's, from the start
  const mapping::MapBuilder* method = nullptr;  ///< nullptr: no map is built
  const sim::Simulator* simulator = nullptr;    ///< nullptr: the scans come from a log
  const choices::Decision* decision = nullptr;  ///< nullptr: none, or of a navigator that has no such
  std::string note = {};                        ///< what a navigator says of its state
  robot::Commanded commanded = {};              ///< what led to the scan, where the loop builds no map itself
  const sim::Sensed* sensed =
      nullptr;  ///< all that was sensed with the scan; nullptr: the scans come from a log
};

/// Looks on while a loop of this room works: record(), buildMap(), exploreOnce(), driveToGoal(). It changes
/// nothing: same input, same bytes, with an observer as without (but for measured times). The loop waits for
/// it, so it may take its time; what it throws ends the loop as Progress::update() does (core::Interrupted).
class StepObserver {
 public:
  virtual ~StepObserver() = default;
  virtual void onStep(const Step& step) = 0;
  /// buildMap(): the method has finished its map after the last scan.
  virtual void onFinished(const mapping::MapBuilder& /*method*/) {}
};

}  // namespace slam::record
