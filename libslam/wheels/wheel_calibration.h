#pragma once
#include "libslam/wheels/path_scale.h"
#include "libslam/wheels/wheel_heading.h"

namespace slam::wheels {

/// Odometry of wheels set right by what the drive so far showed: how long a metre is, how far they turn where
/// the robot does not, and how far they scatter.
class WheelCalibration {
 public:
  explicit WheelCalibration(Told way_told) : scale_(way_told) {}
  /// A step of the wheels (m, rad; in the robot's frame before it), set right.
  core::Pose2 corrected(const core::Pose2& T_wheels) const;
  /// A step: by corrected(), and as it was matched to a map; both in the robot's frame before it. `way_told`
  /// and `turn_told`: of what holds the match along the way and its heading, the scan's share, in [0, 1].
  /// Nothing is learnt of a step that is not finite.
  void learn(const core::Pose2& T_corrected, const core::Pose2& T_matched, double way_told, double turn_told);
  /// Nothing is known of a step.
  void endPiece();
  /// Standard deviation of a corrected step's turn (rad).
  double sigmaTurn_rad(const core::Pose2& T_corrected) const { return heading_.sigma_rad(T_corrected); }
  const PathScale& scale() const { return scale_; }
  const WheelHeading& heading() const { return heading_; }

 private:
  PathScale scale_;
  WheelHeading heading_;
};

}  // namespace slam::wheels
