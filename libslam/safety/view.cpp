#include "libslam/safety/view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"

namespace slam::safety {
namespace {

// Beam angles are sums of products: a beam meant to point straight ahead may be off by a few ulps.
constexpr double kSameAngle_rad = 1e-9;

double wrapToTurn(double angle_rad) {
  const double wrapped = core::wrapToPi(angle_rad);
  if (std::abs(wrapped) < kSameAngle_rad) return 0;
  return wrapped < 0 ? wrapped + 2 * core::kPi : wrapped;
}

}  // namespace

std::vector<SeenBeam> seenBeams(const lidar::Scan& scan) {
  std::vector<SeenBeam> beams;
  beams.reserve(scan.ranges_m.size());
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const float range_m = scan.ranges_m[i];
    const bool nothing = range_m == lidar::kNoReturn;
    if (!nothing && !lidar::isReturn(range_m)) continue;
    beams.push_back({wrapToTurn(scan.angle(i) + scan.T_robot_lidar.phi),
                     nothing ? scan.max_range_m : static_cast<double>(range_m)});
  }
  std::stable_sort(beams.begin(), beams.end(),
                   [](const SeenBeam& a, const SeenBeam& b) { return a.angle_rad < b.angle_rad; });
  return beams;
}

double freeTravel(const std::vector<core::Point2>& points_robot, double direction_rad, double radius_m) {
  const auto [s, c] = core::sinCos(direction_rad);
  double free_m = std::numeric_limits<double>::infinity();
  for (const auto& point : points_robot) {
    const double ahead_m = c * point.x + s * point.y;
    const double aside_m = c * point.y - s * point.x;
    if (ahead_m <= 0 || std::abs(aside_m) >= radius_m) continue;
    free_m = std::min(free_m, ahead_m - std::sqrt(radius_m * radius_m - aside_m * aside_m));
  }
  return std::max(0.0, free_m);
}

int quadrantOf(double angle_rad) {
  return std::min(3, static_cast<int>((angle_rad + kSameAngle_rad) / (core::kPi / 2)));
}

}  // namespace slam::safety
