#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <map>
#include <set>
#include <utility>

#include "libslam/bags/ros_frames.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/bags/ros_scan.h"
#include "libslam/core/error.h"
#include "libslam/core/pose2.h"
#include "libslam/files/parameters.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/sweep_note.h"

namespace slam::bags {
namespace {

using mrpt::obs::CObservation2DRangeScan;
using mrpt::poses::CPose3D;

constexpr std::int64_t kSurvey_ns = 10'000'000'000;
constexpr float kUnknownMaxRange_m = 1000;
constexpr size_t kMostNamedTopics = 5;

/// What the first part of a bag tells about the whole.
struct Survey {
  std::set<std::string> scan_frames;
  FrameTree frames;
  std::string odometry_topic;           ///< "": none
  std::string tf_odometry_frame, base;  ///< the parent of `base` in tf, when there is no odometry topic
};

class RosObjects : public objects::ObjectSource {
 public:
  RosObjects(std::string path, OpenRosMessages open, RosReadOptions options)
      : path_(std::move(path)), options_(std::move(options)), open_(std::move(open)), messages_(open_()) {}

  std::shared_ptr<mrpt::serialization::CSerializable> next() override {
    if (!is_surveyed_) survey();
    while (ready_.empty()) {
      RosMessage message;
      if (!messages_->next(message)) {
        requireSomethingRead();
        return nullptr;
      }
      ++met_;
      topic_ = message.channel->topic;
      take(message);
    }
    auto object = std::move(ready_.front());
    ready_.pop_front();
    ++count_;
    return object;
  }
  std::uint64_t count() const override { return count_; }
  double fractionRead() const override { return messages_->fractionRead(); }
  std::string place() const override {
    return "message " + std::to_string(met_) + (topic_.empty() ? "" : " (" + topic_ + ")");
  }

  std::string skipped() const override {
    std::string text;
    const auto add = [&text](const std::string& part) {
      if (!part.empty()) text += (text.empty() ? "" : "; ") + part;
    };
    add(passedOverTopics());
    if (without_stamp_ > 0)
      add(counted(without_stamp_, "header") + " without a stamp took the recorder's time");
    if (empty_scans_ > 0) add(counted(empty_scans_, "laser scan") + " without readings");
    if (bad_transforms_ > 0) add(counted(bad_transforms_, "transform") + " that is none");
    for (const auto& frame : unmounted_)
      add("no transform leads to the lidar's frame '" + shownName(frame) +
          "': it is taken as mounted at the origin");
    add(messages_->remark());
    return text;
  }

 private:
  void take(const RosMessage& message) {
    const auto& channel = *message.channel;
    const bool is_truth = isTruth(channel.topic);
    if (!channel.obstacle.empty()) return passOver(channel);
    if (channel.type == kLaserScanType) return takeScan(message, decode<RosLaserScan>(message));
    if (channel.type == kMultiEchoType)
      return takeScan(message, singleEcho(decode<RosMultiEchoLaserScan>(message)));
    if (isTransforms(channel)) return takeTransforms(message, decode<RosTransforms>(message));
    if (channel.type == kOdometryType && is_truth) return takeTruth(message, decode<RosOdometry>(message));
    if (channel.type == kPoseStampedType && is_truth)
      return takeTruth(message, decode<RosPoseStamped>(message));
    if (channel.type == kOdometryType && channel.topic == survey_.odometry_topic)
      return takeOdometry(message, decode<RosOdometry>(message));
    passOver(channel);
  }

  static bool isTransforms(const RosChannel& channel) {
    return channel.type == kTransformsType || channel.type == kOldTransformsType;
  }
  bool isTruth(const std::string& topic) const {
    const auto& topics = options_.truth_topics;
    return std::find(topics.begin(), topics.end(), topic) != topics.end();
  }
  bool mayBeOdometry(const RosChannel& channel) const {
    if (channel.type != kOdometryType || isTruth(channel.topic)) return false;
    return options_.odometry_topic.empty() || channel.topic == options_.odometry_topic;
  }

  /// Reads the first part of the bag for what must be known before its first scan. Damage is left to the
  /// reading proper.
  void survey() {
    is_surveyed_ = true;
    const auto messages = open_();
    try {
      RosMessage message;
      std::int64_t first_ns = 0;
      for (bool is_first = true; messages->next(message); is_first = false) {
        if (is_first) first_ns = message.received_ns;
        surveyMessage(message);
        if (message.received_ns - first_ns >= kSurvey_ns && surveyIsComplete()) break;
      }
    } catch (const core::InputError&) {
    }
    if (!survey_.odometry_topic.empty()) survey_.tf_odometry_frame.clear();
  }

  void surveyMessage(const RosMessage& message) {
    const auto& channel = *message.channel;
    if (!channel.obstacle.empty()) return;
    if (channel.type == kLaserScanType) {
      survey_.scan_frames.insert(frameName(decode<RosLaserScan>(message).header.frame_id));
    } else if (channel.type == kMultiEchoType) {
      survey_.scan_frames.insert(frameName(decode<RosMultiEchoLaserScan>(message).header.frame_id));
    } else if (mayBeOdometry(channel)) {
      if (survey_.odometry_topic.empty() || channel.topic == "/odom") {
        survey_.odometry_topic = channel.topic;
        survey_.base = frameName(decode<RosOdometry>(message).child_frame_id);
      }
    } else if (isTransforms(channel)) {
      for (const auto& transform : decode<RosTransforms>(message).transforms) surveyTransform(transform);
    }
  }

  void surveyTransform(const RosTransform& transform) {
    const auto parent = frameName(transform.header.frame_id), child = frameName(transform.child_frame_id);
    const auto T_parent_child = toMrptPose(transform.translation, transform.rotation);
    if (!T_parent_child) return;
    survey_.frames.setIfNew(parent, child, *T_parent_child);
    if (survey_.odometry_topic.empty() && survey_.tf_odometry_frame.empty() && isOdometryFrame(parent)) {
      survey_.tf_odometry_frame = parent;
      survey_.base = child;
    }
  }

  bool surveyIsComplete() const {
    if (survey_.odometry_topic.empty() && survey_.tf_odometry_frame.empty()) return false;
    if (survey_.scan_frames.empty()) return false;
    return std::all_of(survey_.scan_frames.begin(), survey_.scan_frames.end(),
                       [this](const std::string& frame) { return mounting(frame).has_value(); });
  }

  std::optional<CPose3D> mounting(const std::string& frame) const {
    for (const std::string& base : {survey_.base, std::string("base_link"), std::string("base_footprint")}) {
      if (base.empty()) continue;
      if (auto T_base_frame = survey_.frames.between(base, frame)) return T_base_frame;
    }
    return std::nullopt;
  }

  template <class Message>
  Message decode(const RosMessage& message) const {
    const auto& channel = *message.channel;
    try {
      if (!channel.other_md5.empty())
        throw core::InputError("a definition with the MD5 sum " + channel.other_md5 + ", expected " +
                               rosMd5(channel.type));
      return decodeRos<Message>(channel.encoding, message.bytes);
    } catch (const core::InputError& error) {
      fail(channel.type + ": " + error.what());
    }
  }

  mrpt::Clock::time_point stampOf(const RosMessage& message, const RosHeader& header) {
    std::int64_t stamp_ns = header.stamp_ns;
    if (stamp_ns == 0) {
      ++without_stamp_;
      stamp_ns = message.received_ns;
    }
    return mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicksFromUnixNanoseconds(stamp_ns)));
  }

  void takeScan(const RosMessage& message, const RosLaserScan& scan) {
    if (scan.ranges.empty()) {
      ++empty_scans_;
      return;
    }
    const ScanAngles angles = anglesOf(scan);
    if (!std::isfinite(angles.first_rad) || !std::isfinite(angles.aperture_rad))
      fail("a laser scan with angles that are not finite");
    auto observation = CObservation2DRangeScan::Create();
    observation->timestamp = stampOf(message, scan.header);
    observation->sensorLabel = frameName(message.channel->topic);
    observation->rightToLeft = true;
    observation->aperture = static_cast<float>(angles.aperture_rad);
    const bool has_max_range = std::isfinite(scan.range_max) && scan.range_max > 0;
    observation->maxRange = has_max_range ? scan.range_max : kUnknownMaxRange_m;

    const auto frame = frameName(scan.header.frame_id);
    auto T_base_lidar = mounting(frame);
    if (!T_base_lidar) {
      T_base_lidar = CPose3D();
      if (unmounted_.size() < kMostNamedTopics) unmounted_.insert(frame);
    }
    double centre_rad = core::wrapToPi(angles.first_rad + angles.aperture_rad / 2);
    const bool is_upside_down = T_base_lidar->getRotationMatrix()(2, 2) < 0;
    if (is_upside_down) {
      *T_base_lidar = *T_base_lidar + CPose3D(0, 0, 0, 0, 0, core::kPi);
      centre_rad = -centre_rad;
    }
    if (centre_rad != 0) *T_base_lidar = *T_base_lidar + CPose3D(0, 0, 0, centre_rad, 0, 0);
    observation->sensorPose = *T_base_lidar;
    const bool is_reversed = angles.reversed != is_upside_down;
    setReadings(scan, is_reversed, *observation);
    noteSweep(observation->sensorLabel, timesOf(scan, is_reversed), objects::ticksOf(*observation));
    ready_.push_back(std::move(observation));
  }

  /// Before the scan that it is true of. A time_increment that is no number says as little as none.
  void noteSweep(const std::string& label, const lidar::Sweep& sweep, std::int64_t ticks) {
    if (!std::isfinite(sweep.duration_s) || (sweep.duration_s == 0 && sweeps_.count(label) == 0)) return;
    const std::string text = objects::formatSweepNote({label, sweep});
    if (std::exchange(sweeps_[label], text) != text) ready_.push_back(objects::makeComment(text, ticks));
  }

  void takeTransforms(const RosMessage& message, const RosTransforms& transforms) {
    is_tf_read_ = true;
    for (const auto& transform : transforms.transforms) {
      const auto parent = frameName(transform.header.frame_id), child = frameName(transform.child_frame_id);
      const auto T_parent_child = toMrptPose(transform.translation, transform.rotation);
      if (!T_parent_child) {
        ++bad_transforms_;
        continue;
      }
      survey_.frames.set(parent, child, *T_parent_child);
      if (parent == survey_.tf_odometry_frame && child == survey_.base)
        giveOdometry(stampOf(message, transform.header), *T_parent_child);
    }
  }

  void takeOdometry(const RosMessage& message, const RosOdometry& odometry) {
    giveOdometry(stampOf(message, odometry.header), requirePose(odometry.pose));
  }

  void giveOdometry(const mrpt::Clock::time_point& stamp, const CPose3D& T_odom_base) {
    auto observation = mrpt::obs::CObservationOdometry::Create();
    observation->timestamp = stamp;
    observation->sensorLabel = "ODOMETRY";
    observation->odometry = mrpt::poses::CPose2D(T_odom_base.x(), T_odom_base.y(), T_odom_base.yaw());
    ready_.push_back(std::move(observation));
  }

  template <class Message>
  void takeTruth(const RosMessage& message, const Message& truth) {
    auto observation = mrpt::obs::CObservationRobotPose::Create();
    observation->timestamp = stampOf(message, truth.header);
    observation->sensorLabel = objects::kTruthLabel;
    observation->pose.mean = requirePose(truth.pose);
    ready_.push_back(std::move(observation));
  }

  CPose3D requirePose(const RosPose& pose) const {
    const auto converted = toMrptPose(pose.position, pose.orientation);
    if (!converted) fail("a pose that is not finite, or with a quaternion of length 0");
    return *converted;
  }

  void passOver(const RosChannel& channel) {
    auto& passed = passed_over_[channel.topic];
    ++passed.second;
    passed.first = channel.type + (channel.obstacle.empty() ? "" : " " + channel.obstacle);
  }

  std::string passedOverTopics() const {
    if (passed_over_.empty()) return "";
    std::uint64_t sum = 0;
    std::string names;
    size_t named = 0;
    for (const auto& [topic, passed] : passed_over_) {
      sum += passed.second;
      if (++named <= kMostNamedTopics) names += (named == 1 ? "" : ", ") + topic + " " + passed.first;
    }
    if (named > kMostNamedTopics) names += ", ...";
    return counted(sum, "message") + " of " + counted(named, "topic") + " (" + names + ")";
  }

  void requireSomethingRead() const {
    if (count_ > 0 || empty_scans_ > 0 || is_tf_read_) return;
    const auto passed = passedOverTopics();
    throw core::InputError(path_ + ": " + (passed.empty() ? "holds no messages" : "holds only " + passed) +
                           ", expected laser scans (" + kLaserScanType + ") or odometry (" + kOdometryType +
                           ")");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw core::InputError(path_ + ": " + place() + ": " + what);
  }

  std::string path_;
  RosReadOptions options_;
  OpenRosMessages open_;
  std::unique_ptr<RosMessages> messages_;
  Survey survey_;
  bool is_surveyed_ = false, is_tf_read_ = false;
  std::deque<std::shared_ptr<mrpt::serialization::CSerializable>> ready_;
  std::uint64_t count_ = 0, met_ = 0;
  std::string topic_;
  std::uint64_t without_stamp_ = 0, empty_scans_ = 0, bad_transforms_ = 0;
  std::set<std::string> unmounted_;
  std::map<std::string, std::string> sweeps_;                                 ///< the last note by label
  std::map<std::string, std::pair<std::string, std::uint64_t>> passed_over_;  ///< type, how many, by topic
};

}  // namespace

std::unique_ptr<objects::ObjectSource> makeRosSource(const std::string& path, OpenRosMessages open,
                                                     const RosReadOptions& options) {
  return std::make_unique<RosObjects>(path, std::move(open), options);
}

std::string shownName(std::string_view name) {
  constexpr size_t kMost = 200;
  return core::oneLine(name, kMost);
}

std::string counted(std::uint64_t count, const char* singular) {
  return std::to_string(count) + " " + singular + (count == 1 ? "" : "s");
}

}  // namespace slam::bags
