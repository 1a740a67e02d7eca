#include "libslam/lidar/deskew.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/lidar/lidar.h"

namespace slam::lidar {
namespace {

/// A reading where it would be seen at the scan's stamp.
struct Moved {
  double angle_rad;
  float range_m;
};

/// Two returns side by side are on one surface when the step between them is small beside their distance.
bool onOneSurface(const Moved& a, const Moved& b) {
  constexpr double kStepShare = 0.1, kStep_m = 0.1;
  return isReturn(a.range_m) && isReturn(b.range_m) &&
         std::abs(a.range_m - b.range_m) < kStep_m + kStepShare * std::min(a.range_m, b.range_m);
}

/// Where a ray meets the line through the two.
float crossing(const Moved& a, const Moved& b, double angle_rad) {
  const core::Point2 p = core::polar(a.range_m, a.angle_rad);
  const core::Point2 q = core::polar(b.range_m, b.angle_rad);
  const double ex = q.x - p.x, ey = q.y - p.y;
  const double across = core::cos(angle_rad) * ey - core::sin(angle_rad) * ex;
  const double range_m = across != 0 ? (p.x * ey - p.y * ex) / across : a.range_m;
  const double low = std::min(a.range_m, b.range_m), high = std::max(a.range_m, b.range_m);
  return static_cast<float>(std::clamp(range_m, low, high));
}

std::vector<Moved> movedReadings(const Scan& scan, const core::Pose2& T_previous_robot, double period_s,
                                 const Sweep& sweep) {
  const core::Pose2 T_robot_previous = core::inverse(T_previous_robot);
  const core::Pose2 T_lidar_robot = core::inverse(scan.T_robot_lidar);
  const size_t last = scan.ranges_m.size() - 1;
  std::vector<Moved> moved;
  for (size_t i = 0; i <= last; ++i) {
    const double ago_s = measuredAgo_s(scan, sweep, static_cast<double>(i));
    const core::Pose2 T_robot_then = core::interpolate({}, T_robot_previous, ago_s / period_s);
    const float range_m = scan.ranges_m[i];
    if (!isReturn(range_m)) {
      moved.push_back({scan.angle(i) + T_robot_then.phi, range_m});
      continue;
    }
    const core::Point2 p =
        T_lidar_robot * (T_robot_then * (scan.T_robot_lidar * core::polar(range_m, scan.angle(i))));
    // On the side of the circle where the beam was, so that the order of beams stays.
    const double angle_rad = scan.angle(i) + core::angleDifference(core::atan2(p.y, p.x), scan.angle(i));
    moved.push_back({angle_rad, static_cast<float>(core::hypot(p.x, p.y))});
  }
  return moved;
}

}  // namespace

Sweep sweepOf(const LidarOptions& options) {
  const int first_measured = options.sweep_clockwise ? options.beams - 1 : 0;
  return {secondsBeforeLastBeam(options, first_measured), options.sweep_clockwise};
}

double measuredAgo_s(const Scan& scan, const Sweep& sweep, double beam) {
  const auto last = static_cast<double>(scan.ranges_m.size() - 1);
  const double after_stamp_s = sweep.duration_s * (1 - sweep.stamped_share);
  return sweep.duration_s * (sweep.clockwise ? beam : last - beam) / last - after_stamp_s;
}

Scan deskewed(const Scan& scan, const core::Pose2& T_previous_robot, double period_s, const Sweep& sweep) {
  const bool is_still = T_previous_robot.x == 0 && T_previous_robot.y == 0 && T_previous_robot.phi == 0;
  if (sweep.duration_s <= 0 || scan.ranges_m.size() < 2) return scan;
  Scan result = scan;
  result.deskewing = {sweep, T_previous_robot, period_s, true};
  if (is_still) return result;
  auto moved = movedReadings(scan, T_previous_robot, period_s, sweep);
  if (scan.isFullCircle()) {
    const auto once = moved;
    for (const double turn_rad : {-2 * core::kPi, 2 * core::kPi})
      for (const auto& reading : once) moved.push_back({reading.angle_rad + turn_rad, reading.range_m});
  }
  std::stable_sort(moved.begin(), moved.end(),
                   [](const Moved& a, const Moved& b) { return a.angle_rad < b.angle_rad; });
  size_t next = 0;
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    const double angle_rad = scan.angle(i);
    while (next < moved.size() && moved[next].angle_rad < angle_rad) ++next;
    const Moved* before = next > 0 ? &moved[next - 1] : nullptr;
    const Moved* after = next < moved.size() ? &moved[next] : nullptr;
    const auto isFar = [&](const Moved* reading) {
      return reading == nullptr || std::abs(reading->angle_rad - angle_rad) > scan.step_rad;
    };
    if (isFar(before) && isFar(after)) {
      result.ranges_m[i] = kLostReading;
    } else if (!isFar(before) && !isFar(after) && onOneSurface(*before, *after)) {
      result.ranges_m[i] = crossing(*before, *after, angle_rad);
    } else {
      const bool take_after =
          isFar(before) || (!isFar(after) && after->angle_rad - angle_rad < angle_rad - before->angle_rad);
      result.ranges_m[i] = (take_after ? after : before)->range_m;
    }
  }
  return result;
}

}  // namespace slam::lidar
