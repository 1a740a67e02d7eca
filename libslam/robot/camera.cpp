#include "libslam/robot/camera.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"

namespace slam::robot {
namespace {

using core::kInfinity;

/// Distance ahead at which a line of sight so far below the horizontal meets the floor.
double floorDistance(double height_m, double angle_below_rad) {
  // Not 1 / tan: straight down is in the range.
  return angle_below_rad > 0 ? height_m * core::cos(angle_below_rad) / core::sin(angle_below_rad) : kInfinity;
}

/// Where the visible floor begins and ends ahead of the camera's foot.
BearingSpan depthSpan(const FloorCamera& camera) {
  const VisibleFloor floor = visibleFloor(camera.view);
  return {std::max(0.0, floor.nearest_m - floor.x_m),
          std::min(camera.scan.reach_m, floor.farthest_m - floor.x_m)};
}

double step(const CameraScanOptions& options) {
  return 2 * core::kPi / options.beams_per_circle;
}

/// Bearings to one side of straight ahead under which any floor is visible.
int bearingsAside(const FloorCamera& camera) {
  int aside = 0;
  for (const int most = camera.scan.beams_per_circle / 4; aside < most; ++aside) {
    const auto [begin_m, end_m] = bearingSpan(camera, (aside + 1) * step(camera.scan));
    if (!(begin_m < end_m)) break;
  }
  return aside;
}

void fail(const char* section, const char* key, const std::string& found, const std::string& expected) {
  throw core::InputError("section [" + std::string(section) + "], key '" + key + "': found '" + found +
                         "', expected " + expected);
}

}  // namespace

CameraOptions::CameraOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<CameraOptions>& CameraOptions::table() {
  using O = CameraOptions;
  static const files::ParameterTable<O> rows(
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
                  "visible floor: the pinhole's trapezoid, or the original document's wedge"}});
  return rows;
}

CameraScanOptions::CameraScanOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<CameraScanOptions>& CameraScanOptions::table() {
  using O = CameraScanOptions;
  static const files::ParameterTable<O> rows(
      "camera_scan",
      {{"beams_per_circle", &O::beams_per_circle, 720, 36, 36000,
        "bearings are multiples of 360 degrees by this"},
       {"reach_m", &O::reach_m, 4.0, 0.01, 1000.0, "farther floor is not judged, from the camera's foot"},
       {"rate_hz", &O::rate_hz, 5.0, 0.01, 1000.0, "pictures per second"},
       {"edge_sigma_deg", &O::edge_sigma_rad, 0.1, 0.0, 10.0,
        "standard deviation of the angle under which an obstacle's foot is seen"},
       {"drop_out", &O::drop_out, 0.0, 0.0, 1.0, "probability that nothing is found under a bearing"}});
  return rows;
}

VisibleFloor visibleFloor(const CameraOptions& options) {
  const double half_y_rad = options.fov_y_rad / 2, tan_half_x = core::tan(options.fov_x_rad / 2);
  const double nearest_m = options.x_m + floorDistance(options.height_m, options.pitch_rad + half_y_rad);
  if (options.area == "original") return {options.x_m, options.y_m, nearest_m, kInfinity, 0, tan_half_x};
  return {options.x_m,
          options.y_m,
          nearest_m,
          options.x_m + floorDistance(options.height_m, options.pitch_rad - half_y_rad),
          options.height_m * core::sin(options.pitch_rad) * tan_half_x,
          core::cos(options.pitch_rad) * tan_half_x};
}

void requireSensible(const FloorCamera& camera) {
  const auto& view = camera.view;
  const auto degrees = [](double rad) {
    return files::formatNumber(std::round(core::radToDeg(rad) * 1e6) / 1e6);
  };
  if (view.pitch_rad + view.fov_y_rad / 2 <= 0)
    fail("camera", "pitch_deg", degrees(view.pitch_rad),
         "more than " + degrees(-view.fov_y_rad / 2) +
             ": the camera looks above the horizon and sees no floor");
  const auto [begin_m, end_m] = depthSpan(camera);
  if (begin_m >= camera.scan.reach_m)
    fail("camera_scan", "reach_m", files::formatNumber(camera.scan.reach_m),
         "more than Ymin = " + files::formatNumber(std::round(begin_m * 1e6) / 1e6) +
             " m, where the visible floor begins");
  if (begin_m >= end_m)
    fail("camera", "pitch_deg", degrees(view.pitch_rad),
         "a camera whose visible floor begins before it ends");
  if (bearingsAside(camera) == 0)
    fail("camera_scan", "beams_per_circle", std::to_string(camera.scan.beams_per_circle),
         "more, for a camera that sees floor under fewer than three bearings");
}

BearingSpan bearingSpan(const FloorCamera& camera, double bearing_rad) {
  const double cosine = core::cos(bearing_rad), tangent = std::abs(core::tan(bearing_rad));
  if (cosine < 1e-9) return {0, 0};
  const VisibleFloor floor = visibleFloor(camera.view);
  auto [begin_m, end_m] = depthSpan(camera);
  // Inside the sides where X tangent < half width at the foot + slope X.
  const double room = floor.half_width_slope - tangent;
  if (room < 0) end_m = std::min(end_m, floor.half_width_at_foot_m / -room);
  if (room > 0) begin_m = std::max(begin_m, -floor.half_width_at_foot_m / room);
  if (room == 0 && floor.half_width_at_foot_m <= 0) return {0, 0};
  return {begin_m / cosine, std::min(end_m / cosine, depthSpan(camera).end_m)};
}

lidar::LidarOptions asLidar(const FloorCamera& camera) {
  const auto [begin_m, end_m] = depthSpan(camera);
  const int aside = bearingsAside(camera);
  lidar::LidarOptions lidar;
  lidar.fov_rad = 2 * aside * step(camera.scan);
  lidar.beams = 2 * aside + 1;
  lidar.min_range_m = begin_m;
  lidar.max_range_m = end_m;
  lidar.sigma_m = edgeSigma(camera, 3.0);
  lidar.drop_out = camera.scan.drop_out;
  lidar.rate_hz = camera.scan.rate_hz;
  lidar.mount_x_m = camera.view.x_m;
  lidar.mount_y_m = camera.view.y_m;
  return lidar;
}

double wholeHalfAngle(const FloorCamera& camera) {
  const double most_m = depthSpan(camera).end_m;
  const int aside = bearingsAside(camera);
  int whole = 0;
  while (whole < aside && bearingSpan(camera, (whole + 1) * step(camera.scan)).end_m >= most_m) ++whole;
  return whole * step(camera.scan);
}

double edgeSigma(const FloorCamera& camera, double range_m) {
  const double height_m = camera.view.height_m;
  return (range_m * range_m + height_m * height_m) / height_m * camera.scan.edge_sigma_rad;
}

void applyCameraErrors(const FloorCamera& camera, core::RandomStream& random, std::vector<float>& ranges_m) {
  constexpr double kBelow = 1 - 1e-6;  // a reading at the end of what is seen would be none
  const double height_m = camera.view.height_m, most_m = depthSpan(camera).end_m;
  const int middle = static_cast<int>(ranges_m.size()) / 2;
  for (int beam = 0; beam < static_cast<int>(ranges_m.size()); ++beam) {
    const double error_rad = camera.scan.edge_sigma_rad * random.normal();
    const bool is_lost = random.chance(camera.scan.drop_out);
    float& range_m = ranges_m[static_cast<size_t>(beam)];
    const auto [begin_m, end_m] = bearingSpan(camera, (beam - middle) * step(camera.scan));
    if (is_lost || range_m < begin_m || !(begin_m < end_m)) {
      range_m = lidar::kLostReading;
    } else if (range_m >= end_m) {
      range_m = end_m >= most_m ? lidar::kNoReturn : lidar::kLostReading;
    } else {
      const double below_rad = core::atan2(height_m, static_cast<double>(range_m)) + error_rad;
      const double seen_m = floorDistance(height_m, std::max(0.0, below_rad));
      range_m = static_cast<float>(std::clamp(seen_m, begin_m, end_m * kBelow));
    }
  }
}

}  // namespace slam::robot
