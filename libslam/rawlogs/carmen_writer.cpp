#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <array>
#include <charconv>
#include <cmath>
#include <map>

#include "libslam/core/error.h"
#include "libslam/core/fixed_number.h"
#include "libslam/files/files.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/rawlogs/carmen_log.h"

namespace slam::rawlogs {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;

constexpr int kDecimals = 6;       // of poses, speeds and stamps: CARMEN's logger writes so many
constexpr int kAngleDecimals = 9;  // of a field of view: an error at its end is multiplied by the readings
constexpr int kOldRangeDecimals = 2, kNewRangeDecimals = 3;  // at least; as CARMEN's logger
constexpr double kSameGeometry = 1e-6;
constexpr int kMostNewLasers = 9;
constexpr const char* kUnknownLaser = "99";  // laser_type
constexpr const char* kNoAcceleration = "0.000000";
constexpr const char* kNoSafety = "0.000000 0.000000 0.000000";

/// The shortest decimals that give the float again, but at least so many.
void appendRange(std::string& text, float range_m, int least_decimals) {
  std::array<char, 64> buffer{};  // the smallest float has 46 decimals and 8 digits
  const auto result =
      std::to_chars(buffer.data(), buffer.data() + buffer.size(), range_m, std::chars_format::fixed);
  const std::string_view digits(buffer.data(), static_cast<size_t>(result.ptr - buffer.data()));
  text += digits;
  const size_t point = digits.find('.');
  int decimals = 0;
  if (point == std::string_view::npos)
    text += '.';
  else
    decimals = static_cast<int>(digits.size() - point) - 1;
  for (; decimals < least_decimals; ++decimals) text += '0';
}

void appendNumbers(std::string& text, std::initializer_list<double> values, int decimals = kDecimals) {
  for (const double value : values) {
    text += ' ';
    core::appendFixed(text, value, decimals);
  }
}

void appendPose(std::string& text, const core::Pose2& pose) {
  appendNumbers(text, {pose.x, pose.y, pose.phi});
}

/// In a log whose headings count whole turns the laser's does too.
core::Pose2 laserPose(const core::Pose2& T_odom_robot, const core::Pose2& T_robot_lidar) {
  core::Pose2 pose = T_odom_robot * T_robot_lidar;
  if (std::abs(T_odom_robot.phi) > core::kPi) pose.phi = T_odom_robot.phi + T_robot_lidar.phi;
  return pose;
}

bool endsWith(const std::string& text, std::string_view end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

/// A sweep as CARMEN knows it: counter-clockwise, with a first angle.
struct Sweep {
  double first_angle_rad = 0, step_rad = 0, max_range_m = 0, accuracy_m = 0;
  core::Pose2 T_robot_lidar;
  std::vector<float> ranges_m;
  std::vector<int> remissions;
};

Sweep sweepOf(const CObservation2DRangeScan& scan, const core::Pose2& mount, double first_angle_rad) {
  Sweep sweep;
  const size_t readings = scan.getScanSize();
  sweep.step_rad = static_cast<double>(scan.aperture) / static_cast<double>(readings - 1);
  sweep.first_angle_rad = first_angle_rad;
  sweep.max_range_m = scan.maxRange;
  sweep.accuracy_m = scan.stdError;
  sweep.T_robot_lidar = mount;
  for (size_t i = 0; i < readings; ++i) {
    const size_t beam = lidar::isRightToLeft(scan) ? i : readings - 1 - i;
    const float range_m = scan.getScanRange(beam);
    const bool is_finite = std::isfinite(range_m);
    // Without its mark an invalid reading would look like a distance.
    const bool is_lost =
        !is_finite || (!scan.getScanRangeValidity(beam) && range_m > 0 && range_m < 0.99F * scan.maxRange);
    float written_m = is_lost ? 0 : range_m;
    if (!scan.getScanRangeValidity(beam) && written_m >= 0.99F * scan.maxRange)
      written_m = std::max(written_m, scan.maxRange);
    sweep.ranges_m.push_back(written_m);
    if (scan.hasIntensity()) sweep.remissions.push_back(scan.getScanIntensity(beam));
  }
  return sweep;
}

class CarmenSink : public objects::ObjectSink {
 public:
  explicit CarmenSink(const std::string& path) : file_(path) {}

  void write(const mrpt::serialization::CSerializable& object) override {
    if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&object))
      writeScan(*scan);
    else if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&object))
      takeOdometry(*odometry);
    else if (const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(&object))
      takeComment(*comment);
    else if (const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&object))
      takePose(*pose);
    else
      drop("other objects");
  }

  void close() override { file_.commit(); }

 private:
  /// The stamp in seconds, or the newest one before; false without any.
  bool stampOf(const mrpt::obs::CObservation& observation, double& time_s) {
    if (objects::ticksOf(observation) != objects::kNoStamp)
      newest_ticks_ = objects::ticksOf(observation);
    else if (newest_ticks_ == objects::kNoStamp)
      return false;
    time_s = objects::secondsFromMrptTicks(newest_ticks_);
    if (!has_start_) start_s_ = time_s, has_start_ = true;
    return true;
  }

  void writeLine(std::string line, double time_s) {
    appendNumbers(line, {time_s});
    line += ' ' + host_;
    appendNumbers(line, {time_s - start_s_});
    file_.append(line + '\n');
  }

  void takeComment(const mrpt::obs::CObservationComment& comment) {
    const std::string_view text = comment.text;
    if (text.substr(0, kCarmenNote.size()) == kCarmenNote) {
      takeNote(comment.text.substr(kCarmenNote.size()));
    } else if (text.substr(0, kCarmenLine.size()) == kCarmenLine) {
      settings_.takeLine(text.substr(kCarmenLine.size()));
      file_.append(comment.text.substr(kCarmenLine.size()) + '\n');
    } else {
      for (size_t begin = 0; begin <= comment.text.size();) {
        const size_t end = std::min(comment.text.find('\n', begin), comment.text.size());
        file_.append("# " + comment.text.substr(begin, end - begin) + '\n');
        begin = end + 1;
      }
    }
  }

  void takeNote(const std::string& text) {
    const size_t blank = text.find(' ');
    if (blank == std::string::npos) return;
    if (text.compare(0, blank, "host") == 0) {
      host_ = text.substr(blank + 1);
      return;
    }
    const size_t value = text.find(' ', blank + 1);
    if (value != std::string::npos) notes_[text.substr(0, value)] = text.substr(value + 1);
  }

  std::string noteOr(const std::string& key, const char* otherwise) const {
    const auto found = notes_.find(key);
    return found == notes_.end() ? otherwise : found->second;
  }

  void takeOdometry(const CObservationOdometry& odometry) {
    odometry_ = objects::fromMrpt(odometry.odometry);
    if (odometry.hasVelocities)
      tv_mps_ = odometry.velocityLocal.vx, rv_radps_ = odometry.velocityLocal.omega;
    else
      tv_mps_ = rv_radps_ = 0;
    // It comes back within its scan's line.
    if (endsWith(odometry.sensorLabel, kOdometrySuffix)) return;
    double time_s = 0;
    if (!stampOf(odometry, time_s)) return drop("odometry readings without a stamp");
    std::string line = "ODOM";
    appendPose(line, odometry_);
    appendNumbers(line, {tv_mps_, rv_radps_});
    writeLine(line + ' ' + noteOr("ODOM accel", kNoAcceleration), time_s);
  }

  void takePose(const mrpt::obs::CObservationRobotPose& pose) {
    if (endsWith(pose.sensorLabel, kPoseSuffix)) {
      laser_pose_ = objects::fromMrpt(pose.pose.mean);
      laser_pose_of_ = pose.sensorLabel;
      return;
    }
    double time_s = 0;
    if (pose.sensorLabel != objects::kTruthLabel || !stampOf(pose, time_s)) return drop("robot poses");
    std::string line = "TRUEPOS";
    appendPose(line, objects::fromMrpt(pose.pose.mean));
    appendPose(line, odometry_);
    writeLine(line, time_s);
  }

  void writeScan(const CObservation2DRangeScan& scan) {
    double time_s = 0;
    if (scan.getScanSize() < 2) return drop("scans of fewer than 2 readings");
    if (!stampOf(scan, time_s)) return drop("scans without a stamp");
    if (writeOldScan(scan, time_s)) return;
    const std::string kind = kindOf(scan.sensorLabel);
    if (kind.empty()) return drop("scans of a tenth lidar");
    writeNewScan(scan, kind, time_s);
  }

  /// False when an FLASER or RLASER line would not be read as this scan.
  bool writeOldScan(const CObservation2DRangeScan& scan, double time_s) {
    const std::string& kind = scan.sensorLabel;
    if (kind != "FLASER" && kind != "RLASER") return false;
    const auto pose = objects::fromMrpt(scan.sensorPose);
    const bool is_rear = kind == "RLASER";
    auto T_odom_laser = laserPose(odometry_, {pose.x, pose.y, is_rear ? core::kPi : 0});
    if (laser_pose_of_ == kind + kPoseSuffix) T_odom_laser = laser_pose_;
    laser_pose_of_.clear();
    const auto geometry = settings_.geometry(scan.getScanSize(), is_rear, odometry_, T_odom_laser);
    const double aperture_rad = geometry.step_rad * static_cast<double>(scan.getScanSize() - 1);
    const auto& mount = geometry.T_robot_lidar;
    const double yaw_rad = mount.phi + geometry.first_angle_rad + aperture_rad / 2;
    const bool is_same =
        std::abs(static_cast<double>(scan.aperture) - aperture_rad) < kSameGeometry &&
        std::abs(static_cast<double>(scan.maxRange) - geometry.max_range_m) < 1e-4 &&
        std::abs(pose.x - mount.x) < kSameGeometry && std::abs(pose.y - mount.y) < kSameGeometry &&
        std::abs(core::angleDifference(pose.phi, yaw_rad)) < kSameGeometry && lidar::isRightToLeft(scan);
    if (!is_same) return false;
    const auto sweep = sweepOf(scan, mount, geometry.first_angle_rad);
    std::string line = kind + ' ' + std::to_string(sweep.ranges_m.size());
    appendRanges(line, sweep, kOldRangeDecimals);
    appendPose(line, T_odom_laser);
    appendPose(line, odometry_);
    writeLine(std::move(line), time_s);
    return true;
  }

  std::string kindOf(const std::string& label) {
    const auto isNumbered = [&label](std::string_view name) {
      return label.size() == name.size() + 1 && label.compare(0, name.size(), name) == 0 &&
             std::isdigit(static_cast<unsigned char>(label.back())) != 0;
    };
    if (isNumbered("ROBOTLASER") || isNumbered("RAWLASER")) return label;
    const auto known = kinds_.find(label);
    if (known != kinds_.end()) return known->second;
    if (kinds_.size() == kMostNewLasers) return "";
    return kinds_[label] = "ROBOTLASER" + std::to_string(kinds_.size() + 1);
  }

  void writeNewScan(const CObservation2DRangeScan& scan, const std::string& kind, double time_s) {
    const auto pose = objects::fromMrpt(scan.sensorPose);
    const double half_rad = static_cast<double>(scan.aperture) / 2;
    double first_angle_rad = -half_rad;
    const std::string config = configOf(scan, kind, first_angle_rad);
    // A first angle that is not minus half of the sweep is in the sensor's heading.
    const core::Pose2 mount{pose.x, pose.y, core::wrapToPi(pose.phi - (first_angle_rad + half_rad))};
    const auto sweep = sweepOf(scan, mount, first_angle_rad);
    std::string line = kind + ' ' + config + ' ' + std::to_string(sweep.ranges_m.size());
    appendRanges(line, sweep, kNewRangeDecimals);
    line += ' ' + std::to_string(sweep.remissions.size());
    for (const int remission : sweep.remissions) line += ' ' + std::to_string(remission);
    if (kind[1] == 'A') return writeLine(std::move(line), time_s);
    appendPose(line, laserPose(odometry_, mount));
    appendPose(line, odometry_);
    appendNumbers(line, {tv_mps_, rv_radps_});
    writeLine(line + ' ' + noteOr(kind + " safety", kNoSafety), time_s);
  }

  /// From laser_type to remission_mode: as the log said it, when it says the same as the scan.
  std::string configOf(const CObservation2DRangeScan& scan, const std::string& kind,
                       double& first_angle_rad) {
    const double step_rad = static_cast<double>(scan.aperture) / static_cast<double>(scan.getScanSize() - 1);
    std::string noted = noteOr(kind + " config", "");
    std::array<double, 7> fields{};
    if (readNumbers(noted, fields) && std::abs(fields[3] - step_rad) < kSameGeometry &&
        std::abs(fields[4] - static_cast<double>(scan.maxRange)) < 1e-4) {
      first_angle_rad = fields[1];
      return noted;
    }
    std::string config = kUnknownLaser;
    appendNumbers(config, {first_angle_rad, static_cast<double>(scan.aperture), step_rad}, kAngleDecimals);
    appendNumbers(config, {static_cast<double>(scan.maxRange), static_cast<double>(scan.stdError)});
    return config + " 0";
  }

  static bool readNumbers(std::string_view text, std::array<double, 7>& numbers) {
    for (double& number : numbers) {
      const size_t begin = text.find_first_not_of(" \t");
      if (begin == std::string_view::npos) return false;
      text.remove_prefix(begin);
      const auto result = std::from_chars(text.data(), text.data() + text.size(), number);
      if (result.ec != std::errc()) return false;
      text.remove_prefix(static_cast<size_t>(result.ptr - text.data()));
    }
    return true;
  }

  static void appendRanges(std::string& line, const Sweep& sweep, int least_decimals) {
    for (const float range_m : sweep.ranges_m) {
      line += ' ';
      appendRange(line, range_m, least_decimals);
    }
  }

  files::GrowingFile file_;
  CarmenSettings settings_;
  std::string host_ = "nohost";
  std::map<std::string, std::string> notes_, kinds_;
  core::Pose2 odometry_, laser_pose_;
  std::string laser_pose_of_;  ///< label of the laser pose that waits for its scan
  double tv_mps_ = 0, rv_radps_ = 0, start_s_ = 0;
  bool has_start_ = false;
  std::int64_t newest_ticks_ = objects::kNoStamp;
};

}  // namespace

std::unique_ptr<objects::ObjectSink> createCarmenLog(const std::string& path) {
  return std::make_unique<CarmenSink>(path);
}

}  // namespace slam::rawlogs
