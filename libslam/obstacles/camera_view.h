#pragma once
#include <vector>

#include "libslam/obstacles/visible_area.h"
#include "libslam/robot/camera.h"

namespace slam::obstacles {

using CameraOptions = robot::CameraOptions;

/// The floor that the camera sees, robot::VisibleFloor, as an area. Borders count as not visible. Obstacles
/// hide nothing: the document forgets what stands behind one.
class CameraView : public VisibleArea {
 public:
  explicit CameraView(const CameraOptions& options);

  bool contains(const core::Point2& p_robot) const override;
  std::vector<core::Point2> outline(double reach_m) const override;

  /// Ymin and Ymax as x in the robot frame: where the visible floor begins and ends straight ahead. +infinity
  /// where there is none.
  double nearest_m() const { return floor_.nearest_m; }
  double farthest_m() const { return floor_.farthest_m; }
  /// Xm at a place `x_m` ahead in the robot frame; negative behind the camera, where nothing is visible.
  double halfWidth_m(double x_m) const { return floor_.halfWidth_m(x_m); }

 private:
  robot::VisibleFloor floor_;
};

}  // namespace slam::obstacles
