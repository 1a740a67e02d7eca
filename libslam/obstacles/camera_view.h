#pragma once
#include <string>
#include <vector>

#include "libslam/core/parameters.h"
#include "libslam/obstacles/visible_area.h"

namespace slam::obstacles {

/// Where the camera sits and how wide it sees; section [camera]. In the founding document's letters: x_m is
/// YC, -y_m is XC, height_m is ZC. It looks along the robot's heading.
struct CameraOptions {
  double x_m, y_m;              ///< of the optical centre, in the robot frame
  double height_m;              ///< of the optical centre above the floor
  double pitch_rad;             ///< of the optical axis below the horizontal
  double fov_x_rad, fov_y_rad;  ///< whole view angles of the picture, left to right and top to bottom
  std::string area;             ///< exact | original

  CameraOptions();
  static const core::ParameterTable<CameraOptions>& table();
};

/// The floor that a pinhole camera sees. With X the distance ahead of the camera's foot, Y the distance to the
/// left of it, H the height, p the pitch, a and b half the view angles (x and y), a floor point has the depth
/// D = X cos p + H sin p along the optical axis, lies V = H cos p - X sin p below the axis and Y beside it, and
/// is in the picture when |V| < D tan b and |Y| < D tan a. Solved for X:
///
///   nearest   Ymin = H / tan(p + b)      nothing is visible unless p + b > 0
///   farthest  Ymax = H / tan(p - b)      infinite when p <= b: the horizon is in the picture
///   half width at X:  Xm = (X cos p + H sin p) tan a
///
/// The founding document has the same Ymin, no Ymax, and Xm = X tan a ("original"). The two widths are equal
/// for a level camera; otherwise the exact one is wider nearer than H / tan(p / 2), where they cross, and
/// narrower beyond, by cos p far away. So the original remembers ghosts near the camera that are gone, and
/// forgets obstacles far ahead at the sides that the camera cannot see. Borders count as not visible. Obstacles
/// hide nothing: the document forgets what stands behind one.
class CameraView : public VisibleArea {
 public:
  explicit CameraView(const CameraOptions& options);

  bool contains(const core::Point2& p_robot) const override;
  std::vector<core::Point2> outline(double reach_m) const override;

  /// Ymin and Ymax as x in the robot frame: where the visible floor begins and ends straight ahead. +infinity
  /// where there is none.
  double nearest_m() const { return nearest_m_; }
  double farthest_m() const { return farthest_m_; }
  /// Xm at a place `x_m` ahead in the robot frame; negative behind the camera, where nothing is visible.
  double halfWidth_m(double x_m) const { return half_width_at_foot_m_ + half_width_slope_ * (x_m - x_m_); }

 private:
  double x_m_, y_m_;
  double nearest_m_, farthest_m_;
  double half_width_at_foot_m_, half_width_slope_;
};

}  // namespace slam::obstacles
