#pragma once
#include "libslam/core/rigid_motion2.h"
#include "libslam/keyframes/types.h"
#include "libslam/lidar/scan.h"

namespace slam::keyframes {

/// The beams of a scan, and what they say of points.
class Beams {
 public:
  /// Of points in the axes that T_robot_points takes them from. The scan has to outlive this.
  Beams(const lidar::Scan& scan, const core::Pose2& T_robot_points);

  Sight say(const core::Point2& p) const;
  /// The same of every `stride`-th of many points.
  View sayOf(const std::vector<scanmatch::PatchPoint>& points, std::size_t stride) const;

 private:
  Sight sayTo(const core::Point2& p_lidar) const;
  long beamTowards(const core::Point2& p_lidar) const;
  long beamAt(const core::Point2& p_lidar) const;

  const lidar::Scan& scan_;
  core::RigidMotion2 T_lidar_points_;
  double beams_per_rad_, beams_per_turn_, error_;
  const double* angles_;  ///< a table, see beams.cpp
};

}  // namespace slam::keyframes
