#include "libslam/safety/free_ways.h"

#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::safety {
namespace {

// The original sectors are the first and last eighth of the circle: an eighth on either side of the middle.
constexpr double kHalfSector_rad = core::kPi / 4;
// A beam meant for the sector's edge belongs to it, however its angle was rounded.
constexpr double kRounding_rad = 1e-9;

double returnDistance(const lidar::Scan& scan, size_t beam) {
  const double range_m = scan.ranges_m[beam], angle_rad = scan.angle(beam);
  const core::Point2 p_lidar = core::polar(range_m, angle_rad);
  const core::Point2 p_robot = scan.T_robot_lidar * p_lidar;
  return core::hypot(p_robot.x, p_robot.y);
}

bool sectorIsFree(const lidar::Scan& scan, double middle_rad, double clearance_m,
                  const std::vector<core::Point2>& remembered) {
  for (const auto& p : remembered) {
    const double aside_rad = std::abs(core::angleDifference(core::atan2(p.y, p.x), middle_rad));
    if (aside_rad <= kHalfSector_rad + kRounding_rad && core::hypot(p.x, p.y) < clearance_m) return false;
  }
  size_t seen = 0;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double beam_rad = scan.angle(i) + scan.T_robot_lidar.phi;
    const double aside_rad = std::abs(core::angleDifference(beam_rad, middle_rad));
    if (aside_rad > kHalfSector_rad + kRounding_rad) continue;
    const bool is_return = lidar::isReturn(scan.ranges_m[i]);
    if (is_return && returnDistance(scan, i) < clearance_m) return false;
    if (is_return || scan.ranges_m[i] == lidar::kNoReturn) ++seen;
  }
  return static_cast<double>(seen) * scan.step_rad >= kHalfSector_rad;
}

}  // namespace

FreeWays canMove(const lidar::Scan& scan, double clearance_m, const std::vector<core::Point2>& remembered) {
  const bool front = sectorIsFree(scan, 0, clearance_m, remembered);
  const bool rear = sectorIsFree(scan, core::kPi, clearance_m, remembered);
  if (front) return rear ? FreeWays::kBoth : FreeWays::kFrontOnly;
  return rear ? FreeWays::kRearOnly : FreeWays::kNone;
}

}  // namespace slam::safety
