#include <mrpt/math/CQuaternion.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "libslam/bags/ros_objects.h"
#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/objects/mrpt_time.h"

namespace slam::bags {
namespace {

using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::poses::CPose3D;

constexpr const char* kBaseFrame = "base_link";
constexpr const char* kOdomFrame = "odom";
constexpr const char* kWorldFrame = "world";

RosVector3 positionOf(const CPose3D& pose) {
  return {pose.x(), pose.y(), pose.z()};
}
RosQuaternion orientationOf(const CPose3D& pose) {
  // As in reading: a turn about z alone keeps its angle without the way through a matrix.
  if (pose.pitch() == 0 && pose.roll() == 0)
    return {0, 0, core::sin(pose.yaw() / 2), core::cos(pose.yaw() / 2)};
  mrpt::math::CQuaternionDouble q;
  pose.getAsQuaternion(q);
  return {q.x(), q.y(), q.z(), q.r()};
}

RosLaserScan toRos(const CObservation2DRangeScan& observation) {
  RosLaserScan scan;
  const size_t beams = observation.getScanSize();
  const float half_rad = observation.aperture / 2;
  scan.angle_min = -half_rad;
  scan.angle_max = half_rad;
  scan.angle_increment =
      beams > 1 ? static_cast<float>(observation.aperture / static_cast<double>(beams - 1)) : 0.0F;
  scan.range_max = observation.maxRange;
  scan.ranges.resize(beams);
  if (observation.hasIntensity()) scan.intensities.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    const size_t from = lidar::isRightToLeft(observation) ? i : beams - 1 - i;
    const float range_m = observation.getScanRange(from);
    // The meaning of invalid readings is that of lidar::fromMrpt().
    const bool far = std::isfinite(range_m) && range_m >= 0.99F * observation.maxRange;
    float reading = std::numeric_limits<float>::quiet_NaN();
    if (observation.getScanRangeValidity(from) && std::isfinite(range_m) && range_m > 0)
      reading = range_m;
    else if (far)
      reading = std::numeric_limits<float>::infinity();
    scan.ranges[i] = reading;
    if (observation.hasIntensity())
      scan.intensities[i] = static_cast<float>(observation.getScanIntensity(from));
  }
  return scan;
}

class RosObjectSink : public objects::ObjectSink {
 public:
  explicit RosObjectSink(std::unique_ptr<RosBagWriter> writer) : writer_(std::move(writer)) {}

  void write(const mrpt::serialization::CSerializable& object) override {
    if (const auto* observation = dynamic_cast<const CObservation*>(&object))
      writeObservation(*observation);
    else
      drop(object.GetRuntimeClass()->className);
  }

  void close() override { writer_->close(); }

 private:
  void writeObservation(const CObservation& observation) {
    const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation);
    const auto* odometry = dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation);
    const auto* truth = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation);
    if (truth != nullptr && truth->sensorLabel != objects::kTruthLabel) truth = nullptr;
    if (scan == nullptr && odometry == nullptr && truth == nullptr)
      return drop(observation.GetRuntimeClass()->className);
    const auto stamp_ns = stampOf(observation.timestamp);
    if (!stamp_ns) return drop("without a stamp that ROS can hold");
    if (scan != nullptr) writeScan(*stamp_ns, *scan);
    if (odometry != nullptr) writeOdometry(*stamp_ns, *odometry);
    if (truth != nullptr) writeTruth(*stamp_ns, *truth);
  }

  std::optional<std::int64_t> stampOf(const mrpt::Clock::time_point& time) {
    const std::int64_t ticks = time.time_since_epoch().count();
    if (ticks == objects::kNoStamp) return newest_stamp_ns_;
    try {
      const std::int64_t stamp_ns = objects::unixNanosecondsFromMrptTicks(ticks);
      if (!rosCanHold(writer_->encoding(), stamp_ns)) return std::nullopt;
      // Receive times stay within an unsigned count of seconds in every container.
      if (stamp_ns < 0) return std::nullopt;
      newest_stamp_ns_ = stamp_ns;
      return stamp_ns;
    } catch (const core::ContractError&) {
      return std::nullopt;
    }
  }

  void writeScan(std::int64_t stamp_ns, const CObservation2DRangeScan& observation) {
    const std::string topic = topicOf(observation.sensorLabel), frame = frameOf(topic);
    const auto known = mountings_.find(frame);
    if (known == mountings_.end() || known->second != observation.sensorPose) {
      mountings_[frame] = observation.sensorPose;
      writeMountings(stamp_ns);
    }
    RosLaserScan scan = toRos(observation);
    scan.header = {stamp_ns, frame};
    send(topic, kLaserScanType, stamp_ns, scan);
  }

  /// All of them each time: a latched topic keeps its last message only.
  void writeMountings(std::int64_t stamp_ns) {
    RosTransforms transforms;
    for (const auto& [frame, T_base_lidar] : mountings_)
      transforms.transforms.push_back(
          {{stamp_ns, kBaseFrame}, frame, positionOf(T_base_lidar), orientationOf(T_base_lidar)});
    send("/tf_static", kTransformsType, stamp_ns, transforms, true);
  }

  void writeOdometry(std::int64_t stamp_ns, const mrpt::obs::CObservationOdometry& reading) {
    const CPose3D pose(reading.odometry);
    RosOdometry odometry;
    odometry.header = {stamp_ns, kOdomFrame};
    odometry.child_frame_id = kBaseFrame;
    odometry.pose = {positionOf(pose), orientationOf(pose)};
    if (reading.hasVelocities) {
      odometry.linear = {reading.velocityLocal.vx, reading.velocityLocal.vy, 0};
      odometry.angular = {0, 0, reading.velocityLocal.omega};
    }
    send("/odom", kOdometryType, stamp_ns, odometry);
    const RosTransforms transforms{
        {{odometry.header, kBaseFrame, odometry.pose.position, odometry.pose.orientation}}};
    send("/tf", kTransformsType, stamp_ns, transforms);
  }

  void writeTruth(std::int64_t stamp_ns, const mrpt::obs::CObservationRobotPose& truth) {
    const RosPoseStamped pose{{stamp_ns, kWorldFrame},
                              {positionOf(truth.pose.mean), orientationOf(truth.pose.mean)}};
    send("/ground_truth", kPoseStampedType, stamp_ns, pose);
  }

  template <class Message>
  void send(const std::string& topic, const char* type, std::int64_t stamp_ns, const Message& message,
            bool is_latched = false) {
    received_ns_ = has_sent_ ? std::max(received_ns_ + 1, stamp_ns) : stamp_ns;
    has_sent_ = true;
    writer_->write(topic, type, is_latched, received_ns_, encodeRos(writer_->encoding(), message));
  }

  /// See ros_logs.h for the rule.
  std::string topicOf(const std::string& label) {
    const auto known = topics_.find(label);
    if (known != topics_.end()) return known->second;
    std::string name;
    for (const char c : label) {
      const bool is_plain =
          (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
      if (is_plain || (c == '/' && !name.empty() && name.back() != '/'))
        name += c;
      else
        name += '_';
    }
    while (!name.empty() && name.back() == '/') name.pop_back();
    const bool says_scan = name.find("scan") != std::string::npos;
    // ROS names do not start with a digit.
    const bool is_topic = says_scan && !(name.front() >= '0' && name.front() <= '9');
    std::string topic = is_topic ? "/" + name : "/scan";
    if (!is_topic && taken_.count(topic)) topic = "/scan_" + name;
    while (taken_.count(topic)) topic += "_2";
    taken_.insert(topic);
    return topics_[label] = topic;
  }

  static std::string frameOf(const std::string& topic) {
    std::string name = topic.substr(1);
    if (name == "scan") return "laser";
    const std::string ending = "/scan";
    if (name.size() > ending.size() && name.compare(name.size() - ending.size(), ending.size(), ending) == 0)
      name.resize(name.size() - ending.size());
    std::replace(name.begin(), name.end(), '/', '_');
    return name;
  }

  std::unique_ptr<RosBagWriter> writer_;
  std::map<std::string, std::string> topics_;  ///< by label
  std::set<std::string> taken_{"/odom", "/tf", "/tf_static", "/ground_truth"};
  std::map<std::string, CPose3D> mountings_;  ///< by frame
  std::optional<std::int64_t> newest_stamp_ns_;
  std::int64_t received_ns_ = 0;
  bool has_sent_ = false;
};

}  // namespace

std::unique_ptr<objects::ObjectSink> makeRosSink(std::unique_ptr<RosBagWriter> writer) {
  return std::make_unique<RosObjectSink>(std::move(writer));
}

}  // namespace slam::bags
