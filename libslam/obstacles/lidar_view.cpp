#include "libslam/obstacles/lidar_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libslam/core/elementary.h"

namespace slam::obstacles {
namespace {

/// Where a beam's visible floor ends.
double depthOf(float reading_m, double max_range_m, double reach_m, double margin_m) {
  if (lidar::isReturn(reading_m)) return std::min(static_cast<double>(reading_m) + margin_m, reach_m);
  return reading_m == lidar::kNoReturn ? std::min(max_range_m, reach_m) : 0.0;
}

}  // namespace

SectorOptions::SectorOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<SectorOptions>& SectorOptions::table() {
  using O = SectorOptions;
  static const files::ParameterTable<O> rows(
      "sector",
      {{"width_deg", &O::width_rad, 60.0, 0.1, 360.0, "angle of the scan that counts, around the heading"},
       {"reach_m", &O::reach_m, 4.0, 0.0, 1000.0, "farther returns do not count; 0 = no limit"},
       {"depth_margin_m", &O::depth_margin_m, 0.1, 0.0, 10.0,
        "remembered points so close behind a return are replaced by it"}});
  return rows;
}

LidarView::LidarView(const lidar::Scan& scan, const SectorOptions& options)
    : T_robot_lidar_(scan.T_robot_lidar),
      first_angle_rad_(scan.first_angle_rad),
      step_rad_(scan.step_rad),
      min_range_m_(scan.min_range_m),
      half_width_rad_(options.width_rad / 2),
      full_circle_(scan.isFullCircle()) {
  const double reach_m = options.reach_m > 0 ? options.reach_m : std::numeric_limits<double>::infinity();
  depths_m_.reserve(scan.ranges_m.size());
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const float reading_m = scan.ranges_m[i];
    depths_m_.push_back(depthOf(reading_m, scan.max_range_m, reach_m, options.depth_margin_m));
    const bool counts = lidar::isReturn(reading_m) && reading_m <= reach_m;
    if (!counts || std::abs(bearing(i)) > half_width_rad_) continue;
    const double angle_rad = scan.angle(i), range_m = reading_m;
    obstacles_.push_back(T_robot_lidar_ * core::polar(range_m, angle_rad));
  }
}

double LidarView::bearing(size_t beam) const {
  return core::wrapToPi(T_robot_lidar_.phi + first_angle_rad_ + static_cast<double>(beam) * step_rad_);
}

double LidarView::visibleDepth_m(double bearing_rad) const {
  const auto beams = static_cast<double>(depths_m_.size());
  // Measured from the middle of the scan, so that the jump of the angle lies where the scan has its gap.
  const double middle_rad = T_robot_lidar_.phi + first_angle_rad_ + (beams - 1) / 2 * step_rad_;
  double beam = std::round(core::angleDifference(bearing_rad, middle_rad) / step_rad_ + (beams - 1) / 2);
  // Right behind the middle the nearest beam is the first or the last one.
  if (full_circle_) beam = std::clamp(beam, 0.0, beams - 1);
  return beam >= 0 && beam < beams ? depths_m_[static_cast<size_t>(beam)] : 0.0;
}

bool LidarView::contains(const core::Point2& p_robot) const {
  const double dx = p_robot.x - T_robot_lidar_.x, dy = p_robot.y - T_robot_lidar_.y;
  const double distance_m = core::hypot(dx, dy), bearing_rad = core::atan2(dy, dx);
  return std::isfinite(distance_m) && distance_m > min_range_m_ && std::abs(bearing_rad) <= half_width_rad_ &&
         distance_m < visibleDepth_m(bearing_rad);
}

std::vector<core::Point2> LidarView::outline(double reach_m) const {
  std::vector<std::pair<double, double>> ends;  // bearing and depth: the scan may begin anywhere
  for (size_t i = 0; i < depths_m_.size(); ++i)
    if (std::abs(bearing(i)) <= half_width_rad_)
      ends.emplace_back(bearing(i), std::min(depths_m_[i], reach_m));
  std::sort(ends.begin(), ends.end());
  std::vector<core::Point2> border;
  border.reserve(ends.size() + 1);
  for (const auto& [bearing_rad, depth_m] : ends)
    border.push_back({T_robot_lidar_.x + depth_m * core::cos(bearing_rad),
                      T_robot_lidar_.y + depth_m * core::sin(bearing_rad)});
  if (!border.empty()) border.push_back(core::position(T_robot_lidar_));
  return border;
}

}  // namespace slam::obstacles
