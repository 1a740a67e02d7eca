#include "libslam/obstacles/camera_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace slam::obstacles {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Distance ahead at which a line of sight so far below the horizontal meets the floor.
double floorDistance(double height_m, double angle_below_rad) {
  // Not 1 / tan: straight down is in the range.
  return angle_below_rad > 0 ? height_m * std::cos(angle_below_rad) / std::sin(angle_below_rad) : kInfinity;
}

}  // namespace

CameraOptions::CameraOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<CameraOptions>& CameraOptions::table() {
  using O = CameraOptions;
  static const core::ParameterTable<O> rows(
      "camera", {{"x_m", &O::x_m, 0.1, -10.0, 10.0, "of the camera ahead of the robot's centre"},
                 {"y_m", &O::y_m, 0.0, -10.0, 10.0, "of the camera to the left of the robot's centre"},
                 {"height_m", &O::height_m, 0.5, 0.001, 100.0, "of the camera above the floor"},
                 {"pitch_deg", &O::pitch_rad, 25.0, -89.0, 90.0, "of its axis below the horizontal"},
                 {"fov_x_deg", &O::fov_x_rad, 60.0, 0.1, 179.0, "view angle from left to right"},
                 {"fov_y_deg", &O::fov_y_rad, 45.0, 0.1, 179.0, "view angle from top to bottom"},
                 {"area",
                  &O::area,
                  "exact",
                  {"exact", "original"},
                  "visible floor: the pinhole's trapezoid, or the founding document's wedge"}});
  return rows;
}

CameraView::CameraView(const CameraOptions& options) : x_m_(options.x_m), y_m_(options.y_m) {
  const double half_y_rad = options.fov_y_rad / 2, tan_half_x = std::tan(options.fov_x_rad / 2);
  nearest_m_ = x_m_ + floorDistance(options.height_m, options.pitch_rad + half_y_rad);
  if (options.area == "original") {
    farthest_m_ = kInfinity;
    half_width_at_foot_m_ = 0;
    half_width_slope_ = tan_half_x;
  } else {
    farthest_m_ = x_m_ + floorDistance(options.height_m, options.pitch_rad - half_y_rad);
    half_width_at_foot_m_ = options.height_m * std::sin(options.pitch_rad) * tan_half_x;
    half_width_slope_ = std::cos(options.pitch_rad) * tan_half_x;
  }
}

bool CameraView::contains(const core::Point2& p_robot) const {
  return p_robot.x > nearest_m_ && p_robot.x < farthest_m_ &&
         std::abs(p_robot.y - y_m_) < halfWidth_m(p_robot.x);
}

std::vector<core::Point2> CameraView::outline(double reach_m) const {
  // The original's wedge begins at the camera's foot even where its nearest line of sight points back.
  const double x0_m = half_width_at_foot_m_ == 0 ? std::max(nearest_m_, x_m_) : nearest_m_;
  const double x1_m = std::min(farthest_m_, x_m_ + reach_m);
  if (!(x0_m < x1_m)) return {};
  const double half0_m = halfWidth_m(x0_m), half1_m = halfWidth_m(x1_m);
  return {{x0_m, y_m_ - half0_m}, {x1_m, y_m_ - half1_m}, {x1_m, y_m_ + half1_m}, {x0_m, y_m_ + half0_m}};
}

}  // namespace slam::obstacles
