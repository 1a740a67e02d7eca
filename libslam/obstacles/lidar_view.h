#pragma once
#include <vector>

#include "libslam/files/parameters.h"
#include "libslam/lidar/scan.h"
#include "libslam/obstacles/visible_area.h"

namespace slam::obstacles {

/// The sector of a lidar's scan that stands for the camera; section [sector].
struct SectorOptions {
  double width_rad;       ///< whole angle, around the robot's heading
  double reach_m;         ///< farther returns are no obstacles and nothing beyond is visible; 0 = no limit
  double depth_margin_m;  ///< how far behind a return the remembered points belong to it

  SectorOptions();
  static const files::ParameterTable<SectorOptions>& table();
};

/// What a scan sees in a sector that looks along the robot's heading from where the lidar is: along each beam
/// the floor from the lidar's minimum range to the return (and `depth_margin_m` behind it, so that a wall
/// remembered just behind its new measurement is not kept twice), up to the maximum range where there is no
/// return, nothing where the reading was lost. Unlike the camera's area it does not reach behind obstacles.
/// A point belongs to the beam nearest in angle; a scan that does not cover the whole sector sees less.
class LidarView : public VisibleArea {
 public:
  LidarView(const lidar::Scan& scan, const SectorOptions& options);

  bool contains(const core::Point2& p_robot) const override;
  std::vector<core::Point2> outline(double reach_m) const override;

  /// The returns within sector and reach, in the robot frame, in beam order: the visible obstacles.
  const std::vector<core::Point2>& obstacles() const { return obstacles_; }

 private:
  /// Of the beam's direction from straight ahead of the robot, in (-pi, pi].
  double bearing(size_t beam) const;
  /// How far the beam at that bearing sees; 0 where it sees nothing.
  double visibleDepth_m(double bearing_rad) const;

  core::Pose2 T_robot_lidar_;
  double first_angle_rad_, step_rad_, min_range_m_, half_width_rad_;
  bool full_circle_;
  std::vector<double> depths_m_;  ///< per beam of the scan
  std::vector<core::Point2> obstacles_;
};

}  // namespace slam::obstacles
