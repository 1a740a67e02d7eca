#pragma once
#include <mrpt/obs/CObservationRobotPose.h>

#include <functional>

#include "libslam/core/random.h"
#include "libslam/doctor/log_check.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/objects/object_stream.h"
#include "libslam/testing/error_of.h"
#include "libslam/testing/temp_folder.h"
#include "tests/logs/log_fixtures.h"
#include "tests/odometry/scene.h"

namespace slam::doctor {

/// A drive in figures of eight through a room of straight walls with a gap to the outside, and what can be
/// wrong with its log.
struct Drive {
  int scans = 300;
  double period_s = 0.2;
  core::Pose2 T_robot_lidar;  ///< where the lidar is
  core::Pose2 T_stated;       ///< where the log says that it is
  double step_factor = 1;     ///< stated over true angle between readings
  double distance_scale = 1, turn_scale = 1, drift_rad_per_m = 0;  ///< of the odometry
  double lead_s = 0;               ///< the odometry's stamps are too early by this
  double odometry_period_s = 0.1;  ///< 0: none
  float no_return_m = 30;          ///< what is written for beams that meet nothing
  bool marks_no_returns = true;    ///< invalid; else a distance like others
  bool is_action_form = false;
  /// May change the observations with their number; false: leave this one out.
  std::function<bool(int, mrpt::obs::CObservation2DRangeScan&)> touch_scan;
  std::function<bool(int, mrpt::obs::CObservationOdometry&)> touch_odometry;
};

inline core::Pose2 poseOnEight(double time_s) {
  const double u = 0.28 * time_s;  // about 0.5 m/s
  const double dx = 1.7 * std::cos(u), dy = 2.0 * std::cos(2 * u);
  return {0.5 + 1.7 * std::sin(u), 0.9 + 1.0 * std::sin(2 * u), std::atan2(dy, dx)};
}

inline odometry::scenes::Scene roomWithGap() {
  odometry::scenes::Scene scene;
  scene.add({{5, 0.2}, {5, 1}, {2.5, 1}, {2.5, 4}, {-1.5, 4}, {-3, 2.2}, {-3, -2}, {5, -2}, {5, -0.4}});
  return scene.box(-1.6, -1.5, -1.1, -0.9);
}

inline mrpt::obs::CObservation2DRangeScan scanOf(const Drive& drive, double time_s,
                                                 core::RandomStream& random) {
  static const auto room = roomWithGap();
  odometry::scenes::Lidar lidar;
  lidar.beams = 181;
  lidar.fov_rad = core::kPi;
  lidar.sigma_m = 0.01;
  lidar.T_robot_lidar = drive.T_robot_lidar;
  auto scan = odometry::scenes::look(room, poseOnEight(time_s), lidar, &random);
  scan.time_s = logs::kStart_s + time_s;
  scan.T_robot_lidar = drive.T_stated;
  scan.step_rad *= drive.step_factor;
  scan.first_angle_rad *= drive.step_factor;
  auto observation = *lidar::toMrpt(scan);
  for (size_t i = 0; i < scan.ranges_m.size(); ++i) {
    if (scan.ranges_m[i] != lidar::kNoReturn) continue;
    observation.setScanRange(i, drive.no_return_m);
    observation.setScanRangeValidity(i, !drive.marks_no_returns);
  }
  if (!drive.marks_no_returns) observation.maxRange = 2 * drive.no_return_m;
  return observation;
}

/// The odometer's pose at a moment, integrated in small steps from the one before.
class Odometer {
 public:
  explicit Odometer(const Drive& drive) : drive_(drive) {}
  core::Pose2 at(double time_s) {
    constexpr double kStep_s = 0.01;
    while (time_s_ < time_s) {
      const double next_s = std::min(time_s_ + kStep_s, time_s);
      auto step = core::between(poseOnEight(time_s_), poseOnEight(next_s));
      step.phi = drive_.turn_scale * step.phi + drive_.drift_rad_per_m * std::hypot(step.x, step.y);
      step.x *= drive_.distance_scale;
      step.y *= drive_.distance_scale;
      pose_ = pose_ * step;
      time_s_ = next_s;
    }
    return pose_;
  }

 private:
  const Drive& drive_;
  double time_s_ = 0;
  core::Pose2 pose_;
};

inline void writeDrive(const Drive& drive, const std::string& path) {
  logs::RawObjects log(path);
  core::RandomStream random(7, "drive");
  Odometer odometer(drive);
  core::Pose2 last;
  int odometry_number = 0;
  double odometry_s = 0;
  for (int i = 0; i < drive.scans; ++i) {
    const double time_s = i * drive.period_s;
    auto scan = scanOf(drive, time_s, random);
    if (drive.is_action_form) {
      const auto pose = odometer.at(time_s + drive.lead_s);
      const auto step = core::between(last, pose);
      last = pose;
      mrpt::obs::CActionRobotMovement2D action;
      action.timestamp = scan.timestamp;
      action.computeFromOdometry(mrpt::poses::CPose2D(step.x, step.y, step.phi), {});
      log << logs::collection(action) << logs::frame(scan);
      continue;
    }
    while (drive.odometry_period_s > 0 && odometry_s <= time_s + 1e-9) {
      const auto pose = odometer.at(odometry_s + drive.lead_s);
      auto odometry = logs::rawOdometry(logs::kStart_s + odometry_s, 0);
      odometry.odometry = mrpt::poses::CPose2D(pose.x, pose.y, pose.phi);
      if (!drive.touch_odometry || drive.touch_odometry(odometry_number, odometry)) log << odometry;
      ++odometry_number;
      odometry_s = odometry_number * drive.odometry_period_s;
    }
    if (!drive.touch_scan || drive.touch_scan(i, scan)) log << scan;
  }
}

inline LogCheck check(const Drive& drive) {
  const testing::TempFolder folder;
  writeDrive(drive, folder / "drive.rawlog");
  return checkLog(folder / "drive.rawlog", "", core::silentProgress());
}

/// Of the drive as it is by default.
inline const LogCheck& healthy() {
  static const LogCheck result = check({});
  return result;
}

/// The findings of a key: "warning: text -> advice" each, joined by lines.
inline std::string said(const std::vector<Finding>& findings, const std::string& key) {
  std::string all;
  for (const auto& finding : findings)
    if (finding.key == key)
      all += (all.empty() ? "" : "\n") + severityName(finding.severity) + ": " + finding.text +
             (finding.advice.empty() ? "" : " -> " + finding.advice);
  return all;
}

/// All that is more than a note, likewise, with its key.
inline std::string complaints(const std::vector<Finding>& findings) {
  std::string all;
  for (const auto& finding : findings)
    if (finding.severity != Severity::kNote)
      all += severityName(finding.severity) + " " + finding.key + ": " + finding.text + "\n";
  return all;
}

}  // namespace slam::doctor
