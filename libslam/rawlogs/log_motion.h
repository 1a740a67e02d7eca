#pragma once
#include <cstdint>
#include <deque>
#include <optional>

#include "libslam/core/pose2.h"

namespace mrpt::obs {
class CActionCollection;
}

namespace slam::rawlogs {

/// What the odometry says about the time since the scan before.
struct Motion {
  core::Pose2 T_previous_robot;
  bool has_reading = false;    ///< anything at all was measured
  bool has_increment = false;  ///< and it says how the robot moved

  void add(const core::Pose2& increment) {
    T_previous_robot = T_previous_robot * increment;
    has_reading = has_increment = true;
  }
  void add(const Motion& later) {
    T_previous_robot = T_previous_robot * later.T_previous_robot;
    has_reading |= later.has_reading;
    has_increment |= later.has_increment;
  }
};

/// Of the wheel odometry, else of a scan matching, else of a spatial action (LogReader says how).
std::optional<core::Pose2> incrementOf(const mrpt::obs::CActionCollection& actions);

/// Absolute odometry readings on their way to the scans they belong to: the rule for bare readings of
/// LogReader.
class BareOdometry {
 public:
  void add(std::int64_t ticks, const core::Pose2& T_odom_robot);
  /// The motion up to a scan of this stamp, since the call before.
  Motion takeUntil(std::int64_t scan_ticks);

 private:
  struct Reading {
    std::int64_t ticks = 0;
    core::Pose2 T_odom_robot;
  };
  void use(const Reading& reading);

  std::deque<Reading> waiting_;
  std::optional<core::Pose2> last_;
  Motion motion_;
};

}  // namespace slam::rawlogs
