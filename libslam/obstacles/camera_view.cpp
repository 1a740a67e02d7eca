#include "libslam/obstacles/camera_view.h"

#include <algorithm>
#include <cmath>

namespace slam::obstacles {

CameraView::CameraView(const CameraOptions& options) : floor_(robot::visibleFloor(options)) {}

bool CameraView::contains(const core::Point2& p_robot) const {
  return p_robot.x > floor_.nearest_m && p_robot.x < floor_.farthest_m &&
         std::abs(p_robot.y - floor_.y_m) < halfWidth_m(p_robot.x);
}

std::vector<core::Point2> CameraView::outline(double reach_m) const {
  // The original's wedge begins at the camera's foot even where its nearest line of sight points back.
  const double x0_m =
      floor_.half_width_at_foot_m == 0 ? std::max(floor_.nearest_m, floor_.x_m) : floor_.nearest_m;
  const double x1_m = std::min(floor_.farthest_m, floor_.x_m + reach_m);
  if (!(x0_m < x1_m)) return {};
  const double half0_m = halfWidth_m(x0_m), half1_m = halfWidth_m(x1_m);
  return {{x0_m, floor_.y_m - half0_m},
          {x1_m, floor_.y_m - half1_m},
          {x1_m, floor_.y_m + half1_m},
          {x0_m, floor_.y_m + half0_m}};
}

}  // namespace slam::obstacles
