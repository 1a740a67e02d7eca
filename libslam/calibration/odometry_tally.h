#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/calibration/clock_offset.h"
#include "libslam/calibration/thinned_sample.h"
#include "libslam/core/pose2.h"

namespace slam::calibration {

inline constexpr const char* kActionStream = "actions";

/// One source of odometry in a log.
struct OdometryFigures {
  std::string stream;  ///< the label of its CObservationOdometry; kActionStream for increments in actions
  std::uint64_t readings = 0;
  double path_m = 0, turned_rad = 0;  ///< jumps left out
  /// Steps too far for a robot: more than half a metre and faster than 3 m/s (or five times the speed that it
  /// keeps under 95 % of the time, if that is more), or more than half a radian and faster than 5 rad/s.
  std::uint64_t jumps = 0;
  double largest_jump_m = 0, largest_jump_at_s = 0;
  ClockOffset clock;
};

/// Path and jumps of one source of odometry, in file order.
class OdometryTally {
 public:
  void add(std::optional<double> time_s, const core::Pose2& pose);
  OdometryFigures figures(const std::string& stream) const;

 private:
  static constexpr double kShortest_m = 0.5, kFast_mps = 3, kSmallest_rad = 0.5, kFast_radps = 5;
  static constexpr std::size_t kMostKept = 4096;
  struct Suspect {
    double moved_m, turned_rad, duration_s, at_s;
  };
  static void note(OdometryFigures& figures, double moved_m, double at_s);
  OdometryFigures figures_;
  std::optional<core::Pose2> last_;
  std::optional<double> last_s_;
  ThinnedSample speeds_mps_;
  std::vector<Suspect> kept_;  ///< what may be jumps, until it is known how fast the robot is
};

}  // namespace slam::calibration
