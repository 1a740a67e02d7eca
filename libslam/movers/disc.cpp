#include "libslam/movers/disc.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"

namespace slam::movers {
namespace {

using core::kInfinity;

/// The beams of a scan, one and more at a positive step, that look into an interval of bearings.
class Fan {
 public:
  Fan(double first_rad, double step_rad, size_t beams) : first_(first_rad), step_(step_rad), beams_(beams) {}

  /// Calls visit(i) for every beam within half_width of the bearing, and perhaps its neighbours: rounding
  /// must not lose a beam that grazes. A beam is visited once per turn in which it looks there.
  template <class Visit>
  void visit(double bearing_rad, double half_width_rad, const Visit& visit) const {
    const double last = static_cast<double>(beams_) - 1;
    const double turn = 2 * core::kPi;
    const double low = bearing_rad - half_width_rad - first_, high = low + 2 * half_width_rad;
    const double span = last * step_;
    const auto first_turn = static_cast<std::int64_t>(std::ceil((-high - step_) / turn));
    for (std::int64_t k = first_turn; low + static_cast<double>(k) * turn <= span + step_; ++k) {
      const double shift = static_cast<double>(k) * turn;
      const auto begin = static_cast<std::int64_t>(std::max(0.0, std::floor((low + shift) / step_)));
      const auto end = static_cast<std::int64_t>(std::min(last, std::ceil((high + shift) / step_)));
      for (std::int64_t i = begin; i <= end; ++i) visit(static_cast<size_t>(i));
    }
  }

 private:
  double first_, step_;
  size_t beams_;
};

}  // namespace

double castRay(const Disc& disc, const core::Point2& origin, const core::Point2& direction) {
  const double x = disc.p.x - origin.x, y = disc.p.y - origin.y;
  const double radius2 = disc.radius_m * disc.radius_m;
  if (x * x + y * y <= radius2) return 0;
  const double along = x * direction.x + y * direction.y, beside = x * direction.y - y * direction.x;
  const double half_chord2 = radius2 - beside * beside;
  return along > 0 && half_chord2 >= 0 ? along - std::sqrt(half_chord2) : kInfinity;
}

void castScan(const std::vector<Disc>& discs, const core::Pose2& T_world_lidar, double first_angle_rad,
              double step_rad, double max_range_m, std::vector<float>& ranges_m) {
  if (!core::isFinite(T_world_lidar)) return;
  const core::Point2 origin = core::position(T_world_lidar);
  const double limit_m = max_range_m > 0 ? max_range_m : kInfinity;
  const auto directionOf = [&](size_t i) -> core::Point2 {
    const double angle_rad = T_world_lidar.phi + first_angle_rad + static_cast<double>(i) * step_rad;
    return core::polar(1, angle_rad);
  };
  const auto shorten = [&](size_t i, const core::Point2& direction, const Disc& disc) {
    const double range_m = castRay(disc, origin, direction);
    if (range_m <= limit_m) ranges_m[i] = std::min(ranges_m[i], static_cast<float>(range_m));
  };
  if (!(step_rad > 0) || ranges_m.size() < 3) {  // a bearing would cost more than it saves
    for (size_t i = 0; i < ranges_m.size(); ++i) {
      const core::Point2 direction = directionOf(i);
      for (const auto& disc : discs) shorten(i, direction, disc);
    }
    return;
  }
  const Fan fan(T_world_lidar.phi + first_angle_rad, step_rad, ranges_m.size());
  for (const auto& disc : discs) {
    const double distance_m = core::distance(origin, disc.p);
    if (distance_m - disc.radius_m > limit_m) continue;
    const double half_width_rad =
        distance_m > disc.radius_m ? core::asin(disc.radius_m / distance_m) : core::kPi;
    fan.visit(core::atan2(disc.p.y - origin.y, disc.p.x - origin.x), half_width_rad,
              [&](size_t i) { shorten(i, directionOf(i), disc); });
  }
}

}  // namespace slam::movers
