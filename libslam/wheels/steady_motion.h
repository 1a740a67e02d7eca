#pragma once
#include <array>
#include <deque>

#include "libslam/core/pose2.h"

namespace slam::wheels {

/// Where a robot whose wheels say nothing gets to if it goes on as it went: by the middle one of its last
/// moves, as a single one along a bare corridor may be matched anywhere, and by its last turn, as turns begin
/// and end between two scans.
///
/// A step may last longer than the one before. Where stamps tell the truth, it goes as much farther; but
/// stamps of real logs leap, and then steps are more alike than their times say. Which of the two holds is
/// learnt from the steps themselves.
class SteadyMotion {
 public:
  /// The step to come, of so many seconds, in the robot's frame before it (m, rad); REQUIRES a positive,
  /// finite number. Standing still before any was noted.
  core::Pose2 next(double since_s);
  /// The step that next() was asked for, as it was matched; m, rad, in the robot's frame before it. One that
  /// is not finite is none.
  void note(const core::Pose2& T_matched);
  /// Whether steps go by their time, rather than being alike whatever it is.
  bool goesByTime() const { return off_[0] <= off_[1]; }

 private:
  struct Motion {
    core::Pose2 T_previous_robot;
    double since_s;
  };
  std::deque<Motion> last_;
  double since_s_ = 0;                   ///< of the step to come
  std::array<core::Pose2, 2> expected_;  ///< by time, and alike
  std::array<double, 2> off_{};          ///< of the two, m and rad together; older ones fade
};

}  // namespace slam::wheels
