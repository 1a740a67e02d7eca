#pragma once
#include <optional>

#include "libslam/core/pose2.h"
#include "libslam/goals/surroundings.h"

namespace slam::goals {

/// Follows the boundary of the obstacles for a disc: from the direction of the last contact the directions
/// are swept away from the wall until the disc fits, as a contour is traced in a raster. What stopped it last
/// is the new contact. So convex and concave corners, thin walls and gaps that are too narrow are all the
/// same case. The poses must be good over one round of the boundary.
class BoundaryFollower {
 public:
  /// tolerance_m: how near to its start a round is closed.
  BoundaryFollower(bool wall_on_right, double tolerance_m)
      : wall_on_right_(wall_on_right), tolerance_m_(tolerance_m) {}

  /// Starts at a pose where the way along `blocked_rad` (robot frame) is blocked.
  void begin(const Surroundings& surroundings, const core::Pose2& T_odom_robot, double blocked_rad);
  /// Goes back along the same boundary, the wall on the other side. Length and round start anew.
  void reverse(const core::Pose2& T_odom_robot);

  enum class Result { kFollowing, kBoxedIn, kWallLost };
  /// Where to go next; direction() tells it while kFollowing. kBoxedIn: the disc fits nowhere.
  Result update(const Surroundings& surroundings, const core::Pose2& T_odom_robot);
  double direction() const { return direction_rad_; }  ///< robot frame

  /// Metres followed since begin() or reverse().
  double length_m() const { return length_m_; }
  /// A round is closed: back where it began with the wall on the same side of the world, after having been
  /// away; or, where the whole round is too short to get away, after a full turn of the contact.
  bool closed() const;
  /// The bearing of the contact in the odom frame: tells the two sides of a narrow passage apart.
  double contactBearing() const { return contact_bearing_rad_; }
  /// Near a pose noted earlier while its contact bearing was `bearing_rad`.
  bool isAt(const core::Pose2& T_odom_then, double bearing_rad) const;

 private:
  void startRound(const core::Pose2& T_odom_robot);
  void track(const core::Pose2& T_odom_robot);
  bool sweep(const Surroundings& surroundings, const core::Pose2& T_odom_robot, double start_rad,
             double radius_m, double step_m);

  bool wall_on_right_;
  double tolerance_m_;
  core::Point2 p_odom_contact_;
  std::optional<double> first_blocked_rad_;  ///< odom frame, until the first sweep
  double direction_rad_ = 0, contact_bearing_rad_ = 0;

  core::Pose2 T_odom_start_, T_odom_last_;
  std::optional<double> start_bearing_rad_;
  double length_m_ = 0, farthest_m_ = 0, wound_rad_ = 0;
};

}  // namespace slam::goals
