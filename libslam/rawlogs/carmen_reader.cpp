#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/rawlogs/carmen_log.h"
#include "libslam/rawlogs/carmen_words.h"

namespace slam::rawlogs {
namespace {

constexpr size_t kLongestLine = 1 << 20;
// CARMEN's reader of logs: carmen_laser_laser_message.accuracy of lines that do not say.
constexpr double kDefaultAccuracy_m = 0.01;
constexpr size_t kMostWaitingLines = 10000;
constexpr double kLargestNumber = 1e6;  // of a range, in metres: far beyond any sensor, within a float
// Odometry and laser pose have six decimals each.
constexpr double kRounding = 2e-6;
constexpr double kMountStep = 1e-4, kMountChange = 1e-3;

bool isLaserOf(std::string_view kind, std::string_view name) {
  return kind.size() == name.size() + 1 && kind.substr(0, name.size()) == name && kind.back() >= '0' &&
         kind.back() <= '9';
}

bool isKnown(std::string_view kind) {
  for (const char* name : {"FLASER", "RLASER", "ODOM", "TRUEPOS", "PARAM", "SYNC"})
    if (kind == name) return true;
  return isLaserOf(kind, "ROBOTLASER") || isLaserOf(kind, "RAWLASER");
}

double roundTo(double value, double step) {
  return std::round(value / step) * step;
}

bool isClose(const core::Pose2& a, const core::Pose2& b, double tolerance) {
  return std::abs(a.x - b.x) <= tolerance && std::abs(a.y - b.y) <= tolerance &&
         std::abs(core::angleDifference(a.phi, b.phi)) <= tolerance;
}

}  // namespace

/// The ranges and remissions of a line.
struct CarmenParser::Sweep {
  std::vector<double> ranges_m;
  std::vector<int> remissions;

  void readRanges(size_t count, CarmenWords& words) {
    ranges_m.resize(count);
    for (size_t i = 0; i < count; ++i) {
      double& range_m = ranges_m[i];
      const auto word = words.next();
      if (!parse(word, range_m) || std::abs(range_m) > kLargestNumber)
        throw core::InputError("found " + (word.empty() ? "the end of the line" : quoted(word)) +
                               ", expected range " + std::to_string(i + 1) + " of " + std::to_string(count) +
                               " (metres)");
    }
  }
  void readRemissions(CarmenWords& words) {
    const size_t count = words.count("the number of remissions");
    remissions.resize(count);
    for (int& remission : remissions) {
      const double value = words.number("a remission");
      constexpr double kMost = 2e9;  // MRPT holds them as 32-bit integers
      remission = static_cast<int>(std::lround(std::clamp(value, -kMost, kMost)));
    }
  }
  std::shared_ptr<mrpt::obs::CObservation2DRangeScan> toScan(const CarmenSettings::Geometry& geometry,
                                                             double accuracy_m, double time_s,
                                                             const std::string& label) const {
    auto scan = std::make_shared<mrpt::obs::CObservation2DRangeScan>();
    scan->timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicks(time_s)));
    scan->sensorLabel = label;
    scan->rightToLeft = true;
    const double aperture_rad = static_cast<double>(ranges_m.size() - 1) * geometry.step_rad;
    scan->aperture = static_cast<float>(aperture_rad);
    scan->maxRange = static_cast<float>(geometry.max_range_m);
    scan->stdError = static_cast<float>(accuracy_m);
    // MRPT's beams are centred on the sensor's x axis; a sweep that is not is the same of a turned sensor.
    const double centre_rad = geometry.first_angle_rad + aperture_rad / 2;
    const auto& mount = geometry.T_robot_lidar;
    scan->sensorPose =
        mrpt::poses::CPose3D(mount.x, mount.y, 0, core::wrapToPi(mount.phi + centre_rad), 0, 0);
    scan->resizeScan(ranges_m.size());
    for (size_t i = 0; i < ranges_m.size(); ++i) {
      scan->setScanRange(i, static_cast<float>(ranges_m[i]));
      scan->setScanRangeValidity(i, ranges_m[i] > 0 && ranges_m[i] < geometry.max_range_m);
    }
    if (remissions.size() == ranges_m.size()) {
      scan->setScanHasIntensity(true);
      for (size_t i = 0; i < remissions.size(); ++i) scan->setScanIntensity(i, remissions[i]);
    }
    return scan;
  }
};

void CarmenParser::note(const std::string& key, const std::string& value, double time_s, Objects& objects) {
  std::string& known = notes_[key];
  if (known == value) return;
  known = value;
  objects.push_back(
      objects::makeComment(std::string(kCarmenNote) + key + " " + value, objects::mrptTicks(time_s)));
}

void CarmenParser::takeOdometry(CarmenWords& words, Objects& objects) {
  const auto pose = words.pose("x y theta");
  const double tv_mps = words.number("tv"), rv_radps = words.number("rv");
  const std::string acceleration(words.word("accel"));
  double ignored = 0;
  if (!parse(acceleration, ignored))
    throw core::InputError("found " + quoted(acceleration) + ", expected accel (a finite number)");
  const double time_s = words.stamp();
  begin(time_s, words.tail(), objects);
  if (ignored != 0 || notes_.count("ODOM accel")) note("ODOM accel", acceleration, time_s, objects);
  auto odometry = objects::makeOdometry(pose, objects::mrptTicks(time_s), objects::kOdometryLabel);
  odometry->hasVelocities = true;
  odometry->velocityLocal = {tv_mps, 0, rv_radps};
  objects.push_back(std::move(odometry));
}

void CarmenParser::takeTruth(CarmenWords& words, Objects& objects) {
  const auto T_world_robot = words.pose("true_x true_y true_theta");
  const auto T_odom_robot = words.pose("odom_x odom_y odom_theta");
  const double time_s = words.stamp();
  begin(time_s, words.tail(), objects);
  objects.push_back(objects::makeOdometry(T_odom_robot, objects::mrptTicks(time_s),
                                          std::string("TRUEPOS") + kOdometrySuffix));
  objects.push_back(objects::makeRobotPose(T_world_robot, objects::mrptTicks(time_s), objects::kTruthLabel));
}

void CarmenParser::takeOldLaser(const std::string& kind, CarmenWords& words, Objects& objects) {
  Sweep sweep;
  sweep.readRanges(words.count("the number of ranges"), words);
  const auto T_odom_laser = words.pose("x y theta"), T_odom_robot = words.pose("odom_x odom_y odom_theta");
  const double time_s = words.stamp();
  begin(time_s, words.tail(), objects);
  const bool is_rear = kind == "RLASER";
  const auto geometry = settings_.geometry(sweep.ranges_m.size(), is_rear, T_odom_robot, T_odom_laser);
  if (!isClose(T_odom_robot * geometry.T_robot_lidar, T_odom_laser, kRounding))
    objects.push_back(objects::makeRobotPose(T_odom_laser, objects::mrptTicks(time_s), kind + kPoseSuffix));
  objects.push_back(objects::makeOdometry(T_odom_robot, objects::mrptTicks(time_s), kind + kOdometrySuffix));
  objects.push_back(sweep.toScan(geometry, kDefaultAccuracy_m, time_s, kind));
}

void CarmenParser::takeNewLaser(const std::string& kind, CarmenWords& words, Objects& objects) {
  const std::string_view config_start = words.rest();
  words.number("laser_type");
  CarmenSettings::Geometry geometry;
  geometry.first_angle_rad = words.number("start_angle");
  words.number("field_of_view");
  geometry.step_rad = words.number("angular_resolution");
  geometry.max_range_m = words.number("maximum_range");
  const double accuracy_m = words.number("accuracy");
  words.number("remission_mode");
  std::string config(config_start.substr(0, config_start.size() - words.rest().size()));
  config.erase(0, config.find_first_not_of(" \t"));

  Sweep sweep;
  sweep.readRanges(words.count("the number of ranges"), words);
  const double steps = static_cast<double>(sweep.ranges_m.size()) - 1;
  if (!(geometry.step_rad > 0) || geometry.step_rad * steps > 2 * core::kPi + 1e-4 ||
      std::abs(geometry.first_angle_rad) > 4 * core::kPi)
    throw core::InputError("found a sweep of " + std::to_string(sweep.ranges_m.size()) + " ranges " +
                           files::formatNumber(geometry.step_rad) + " rad apart from " +
                           files::formatNumber(geometry.first_angle_rad) + ", expected at most one turn");
  if (!(geometry.max_range_m > 0 && geometry.max_range_m <= kLargestNumber))
    throw core::InputError("found maximum_range " + files::formatNumber(geometry.max_range_m) +
                           ", expected a number above 0");
  sweep.readRemissions(words);

  const bool is_raw = kind[1] == 'A';
  if (is_raw) {
    const double time_s = words.stamp();
    begin(time_s, words.tail(), objects);
    note(kind + " config", config, time_s, objects);
    objects.push_back(sweep.toScan(geometry, accuracy_m, time_s, kind));
    return;
  }
  const auto T_odom_laser = words.pose("laser_x laser_y laser_theta"),
             T_odom_robot = words.pose("odom_x odom_y odom_theta");
  const double tv_mps = words.number("tv"), rv_radps = words.number("rv");
  const std::string_view safety_start = words.rest();
  for (const char* name : {"forward_safety_dist", "side_safety_dist", "turn_axis"}) words.number(name);
  std::string safety(safety_start.substr(0, safety_start.size() - words.rest().size()));
  safety.erase(0, safety.find_first_not_of(" \t"));
  const double time_s = words.stamp();
  begin(time_s, words.tail(), objects);
  note(kind + " config", config, time_s, objects);
  note(kind + " safety", safety, time_s, objects);

  const auto shown = core::between(T_odom_robot, T_odom_laser);
  auto& mount = mounts_[kind];
  if (!isClose(mount, shown, kMountChange))
    mount = {roundTo(shown.x, kMountStep), roundTo(shown.y, kMountStep), roundTo(shown.phi, kMountStep)};
  geometry.T_robot_lidar = mount;
  auto odometry = objects::makeOdometry(T_odom_robot, objects::mrptTicks(time_s), kind + kOdometrySuffix);
  odometry->hasVelocities = true;
  odometry->velocityLocal = {tv_mps, 0, rv_radps};
  objects.push_back(std::move(odometry));
  objects.push_back(sweep.toScan(geometry, accuracy_m, time_s, kind));
}

void CarmenParser::takeText(std::string_view line, Objects& objects) {
  settings_.takeLine(line);
  waiting_.push_back(std::string(kCarmenLine) + std::string(line));
  if (newest_ticks_ != objects::kNoStamp || waiting_.size() > kMostWaitingLines) finish(objects);
}

void CarmenParser::finish(Objects& objects) {
  for (auto& text : waiting_) objects.push_back(objects::makeComment(std::move(text), newest_ticks_));
  waiting_.clear();
}

/// Of the objects of a message.
void CarmenParser::begin(double time_s, const std::string& host, Objects& objects) {
  newest_ticks_ = objects::mrptTicks(time_s);
  finish(objects);
  note("host", host, time_s, objects);
}

void CarmenParser::take(std::string_view line, Objects& objects) {
  CarmenWords words(line);
  const std::string_view kind = words.next();
  if (kind.empty()) return;
  const bool is_old_laser = kind == "FLASER" || kind == "RLASER";
  const bool is_new_laser = isLaserOf(kind, "ROBOTLASER") || isLaserOf(kind, "RAWLASER");
  if (kind == "ODOM") {
    takeOdometry(words, objects);
  } else if (kind == "TRUEPOS") {
    takeTruth(words, objects);
  } else if (is_old_laser || is_new_laser) {
    CarmenWords ahead = words;
    if (is_new_laser)
      for (int i = 0; i < 7; ++i) ahead.next();
    const auto readings = ahead.next();
    if (readings == "0" || readings == "1") {
      ++skipped_[std::string(kind) + " of fewer than 2 readings"];
      takeText(line, objects);
    } else if (is_old_laser) {
      takeOldLaser(std::string(kind), words, objects);
    } else {
      takeNewLaser(std::string(kind), words, objects);
    }
  } else {
    constexpr size_t kMostKinds = 100;  // text that is no CARMEN log after all has a new "kind" in every line
    if (kind[0] != '#' && !isKnown(kind)) {
      const std::string name = shownWord(kind);
      ++skipped_[skipped_.size() < kMostKinds || skipped_.count(name) > 0 ? name : "..."];
    }
    takeText(line, objects);
  }
}

std::string CarmenParser::skipped() const {
  std::uint64_t lines = 0;
  std::string kinds;
  for (const auto& [kind, count] : skipped_) {
    lines += count;
    kinds += (kinds.empty() ? "" : ", ") + std::to_string(count) + " " + kind;
  }
  if (lines == 0) return "";
  return std::to_string(lines) + (lines == 1 ? " line" : " lines") + " kept as text only (" + kinds + ")";
}

// --- Files
// ----------------------------------------------------------------------------------------------------

bool looksLikeCarmen(std::string_view start) {
  const auto is_control = [](char c) { return (c >= 0 && c < 32 && c != '\n' && !isBlank(c)) || c == 127; };
  if (std::any_of(start.begin(), start.end(), is_control)) return false;
  for (size_t begin = 0; begin < start.size();) {
    const size_t end = std::min(start.find('\n', begin), start.size());
    const auto line = start.substr(begin, end - begin);
    const size_t kind_end = line.find_first_of(" \t");
    if (kind_end != std::string_view::npos && isKnown(line.substr(0, kind_end))) return true;
    begin = end + 1;
  }
  return false;
}

CarmenObjects::CarmenObjects(const std::string& path) : path_(path), stream_(path) {}

double CarmenObjects::fractionRead() const {
  return static_cast<double>(stream_.fileOffset()) / static_cast<double>(stream_.fileBytes());
}

void CarmenObjects::failAtEnd() const {
  const std::string place = " at byte " + std::to_string(stream_.fileOffset()) + " of " +
                            std::to_string(stream_.fileBytes()) + ", after " + std::to_string(line_) +
                            " good lines";
  if (stream_.failure() == UnpackingStream::Failure::kTruncated)
    throw core::InputError(path_ + ": truncated: the " + stream_.packing() + " data end" + place);
  if (stream_.failure() == UnpackingStream::Failure::kChecksum)
    throw core::InputError(path_ + ": corrupt: the " + stream_.packing() + " checksum does not match" +
                           place);
  throw core::InputError(path_ + ": corrupt: the " + stream_.packing() + " data break (" +
                         stream_.failureText() + ")" + place);
}

bool CarmenObjects::readLine() {
  UnpackingStream::Line line;
  if (!stream_.takeLine(line, kLongestLine)) {
    if (stream_.failure() != UnpackingStream::Failure::kNone) failAtEnd();
    return false;
  }
  const std::string where = path_ + ":" + std::to_string(line_ + 1) + ": ";
  if (!line.is_whole && line.text.size() == kLongestLine)
    throw core::InputError(where + "found a line of more than 1 MiB, expected shorter ones");
  std::string last;
  if (!line.is_whole) {
    // Half a line can look like a whole one.
    last = std::string(line.text);
    stream_.peek(1);
    if (stream_.failure() != UnpackingStream::Failure::kNone) failAtEnd();
    line.text = last;
  }
  try {
    parser_.take(line.text, ready_);
  } catch (const core::InputError& error) {
    ready_.clear();
    throw core::InputError(where + (line.is_whole ? "" : "truncated: the last line has no newline, and ") +
                           error.what());
  }
  ++line_;
  return true;
}

std::shared_ptr<mrpt::serialization::CSerializable> CarmenObjects::next() {
  while (ready_.empty() && readLine()) {
  }
  if (ready_.empty()) parser_.finish(ready_);
  if (ready_.empty()) return nullptr;
  auto object = std::move(ready_.front());
  ready_.pop_front();
  ++count_;
  return object;
}

}  // namespace slam::rawlogs
