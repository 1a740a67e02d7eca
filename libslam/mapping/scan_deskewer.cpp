#include "libslam/mapping/scan_deskewer.h"

namespace slam::mapping {
namespace {

/// What the robot did in a time.
struct RecentMotion {
  core::Pose2 T_previous_robot;
  double period_s;
};

/// The motion up to the scan: the odometry's, else that of the step before where that one had odometry. A
/// motion that is itself from skewed scans would make it worse.
std::optional<RecentMotion> motionUpTo(const StepHistory& history, const robot::Scan& scan,
                                       const core::Pose2& T_previous_robot, bool has_odometry) {
  if (!history.previous_scan) return std::nullopt;
  const double period_s = scan.time_s - history.previous_scan->time_s;
  if (has_odometry && period_s > 0 && core::isFinite(T_previous_robot))
    return RecentMotion{T_previous_robot, period_s};
  if (history.last_had_odometry && history.last_period_s > 0)
    return RecentMotion{history.T_previous_last, history.last_period_s};
  return std::nullopt;
}

}  // namespace

std::optional<robot::Scan> ScanDeskewer::deskewed(const StepHistory& history, const robot::Scan& scan,
                                                  std::optional<robot::Sweep> sweep,
                                                  const core::Pose2& T_previous_robot, bool has_odometry) {
  if (method_.sweep_s > 0) sweep = robot::Sweep{method_.sweep_s, method_.sweep_clockwise};
  if (!sweep || !(sweep->duration_s > 0)) return std::nullopt;
  counts_.swept += history.previous_scan.has_value();
  if (!method_.deskew) return std::nullopt;
  const auto motion = motionUpTo(history, scan, T_previous_robot, has_odometry);
  if (!motion) return std::nullopt;
  ++counts_.set_right;
  return robot::deskewed(scan, motion->T_previous_robot, motion->period_s, *sweep);
}

}  // namespace slam::mapping
