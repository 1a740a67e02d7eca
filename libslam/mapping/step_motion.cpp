#include "libslam/mapping/step_motion.h"

#include <mrpt/math/TPose2D.h>
#include <mrpt/poses/CPose2D.h>

#include <algorithm>

#include "libslam/lidar/mrpt_types.h"

namespace slam::mapping {
namespace {

constexpr double kMostPeriods = 3;  // that a last motion is taken to go on for

/// The last step goes on, as long as it is to this scan.
core::Pose2 lastMotionUntil(const StepHistory& history, const lidar::Scan& scan) {
  if (!history.previous_scan || !(history.last_period_s > 0)) return {};
  const double period_s = scan.time_s - history.previous_scan->time_s;
  return core::interpolate({}, history.T_previous_last,
                           std::clamp(period_s / history.last_period_s, 0.0, kMostPeriods));
}

/// With the heading wrapped as MRPT wraps it, which is not to the last bit what went in.
core::Pose2 asMrptHasIt(const core::Pose2& pose) {
  return lidar::fromMrpt(mrpt::poses::CPose2D(lidar::toMrpt(pose)).asTPose());
}

}  // namespace

bool StepHistory::isReference(const lidar::Scan& scan) const {
  return !reference_scan || lidar::areOfOneLidar(*reference_scan, scan);
}

void StepHistory::note(const lidar::Scan& scan, const core::Pose2& T_previous_robot,
                       const core::Pose2& T_map_after) {
  if (isReference(scan)) {
    reference_scan = scan;
    T_reference_previous = {};
  } else {
    T_reference_previous = T_reference_previous * T_previous_robot;
  }
  const double period_s = previous_scan ? scan.time_s - previous_scan->time_s : 0;
  if (period_s > 0) {
    T_previous_last = core::between(T_map_robot, T_map_after);
    last_period_s = period_s;
  }
  T_map_robot = T_map_after;
  previous_scan = scan;
}

StepMotions::StepMotions(const MethodOptions& method, const odometry::ScanOdometryOptions& scan_odometry,
                         bool goes_on_alone)
    : method_(method), scan_odometry_options_(scan_odometry), goes_on_alone_(goes_on_alone) {}

void StepMotions::noteCommand(const robot::Commanded& commanded, std::uint64_t step,
                              const core::Pose2& T_previous_robot, bool has_odometry) {
  commanded_ = commanded;
  if (commanded.kind != robot::MotionKind::kUnknown) return;
  if (step < commands_.size())
    commanded_ = commands_[step];
  else if (has_odometry)
    commanded_ = wheels_commands_.next(T_previous_robot);
}

/// The estimator may have slept while the wheels did the work: then it is shown the previous scan first.
odometry::ScanMotion StepMotions::fromScans(const StepHistory& history, const lidar::Scan& scan) {
  if (!history.isReference(scan)) {
    odometry::ScanMotion motion;
    motion.T_previous_current = lastMotionUntil(history, scan);
    return motion;
  }
  if (!scan_odometry_) scan_odometry_ = odometry::makeScanOdometry(scan_odometry_options_);
  if (!scan_odometry_saw_previous_ && history.reference_scan) {
    scan_odometry_->reset();
    scan_odometry_->update(*history.reference_scan);
  }
  scan_odometry_saw_previous_ = true;
  auto motion = scan_odometry_->update(scan, commanded_);
  const auto& passed = history.T_reference_previous;
  const bool is_next = passed.x == 0 && passed.y == 0 && passed.phi == 0;
  if (!is_next) motion.T_previous_current = core::between(passed, motion.T_previous_current);
  return motion;
}

methods::StepMotion StepMotions::next(const StepHistory& history, const lidar::Scan& scan,
                                      const core::Pose2& T_previous_robot, bool has_odometry) {
  if (goes_on_alone_) return nextAlone(history, scan, T_previous_robot, has_odometry);
  const bool is_first = !history.previous_scan;
  const bool from_scans = method_.odometry != "wheel" || (!has_odometry && !is_first);
  if (from_scans) {
    const odometry::ScanMotion motion = fromScans(history, scan);
    methods::requireFinite(motion.T_previous_current, "the motion estimated from the scans");
    // The original method stays what it was: how far, it never asks the wheels.
    const bool ask_wheels = !motion.reliable && has_odometry && method_.odometry != "argmax" &&
                            method_.odometry != "argmax_blind";
    if (!ask_wheels || is_first) return {motion.T_previous_current, true, motion};
  } else if (history.isReference(scan)) {
    scan_odometry_saw_previous_ = false;
  }
  const core::Pose2 increment = is_first ? core::Pose2{} : T_previous_robot;
  methods::requireFinite(increment, "the odometry");
  return {increment, true, std::nullopt};
}

core::Pose2 StepMotions::asFed(const methods::StepMotion& motion, const core::Pose2& T_previous_robot) const {
  if (!goes_on_alone_) return asMrptHasIt(motion.T_previous_robot);
  return motion.is_known ? motion.T_previous_robot : T_previous_robot;
}

/// Where there is no odometry such a method knows better than two scans alone.
methods::StepMotion StepMotions::nextAlone(const StepHistory& history, const lidar::Scan& scan,
                                           const core::Pose2& T_previous_robot, bool has_odometry) {
  methods::StepMotion motion{T_previous_robot, has_odometry, std::nullopt};
  if (method_.odometry == "none") {
    motion.is_known = false;
  } else if (method_.odometry != "wheel") {
    motion.T_previous_robot = fromScans(history, scan).T_previous_current;
    motion.is_known = true;
  }
  if (history.previous_scan && motion.is_known)
    methods::requireFinite(motion.T_previous_robot, "the odometry");
  return motion;
}

}  // namespace slam::mapping
