#pragma once
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/serialization/CSerializable.h>

#include <deque>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_objects.h"
#include "libslam/core/pose2.h"
#include "libslam/objects/mrpt_time.h"
#include "tests/logs/log_fixtures.h"

namespace slam::logs {

using Object = std::shared_ptr<mrpt::serialization::CSerializable>;

inline constexpr std::int64_t kRosStart_ns = 1'700'000'000'123'456'700;
inline constexpr float kInf = std::numeric_limits<float>::infinity();
inline constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

inline mrpt::Clock::time_point rosStamp(std::int64_t time_ns) {
  return mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicksFromUnixNanoseconds(time_ns)));
}
inline std::int64_t stampNs(const mrpt::obs::CObservation& observation) {
  return objects::unixNanosecondsFromMrptTicks(observation.timestamp.time_since_epoch().count());
}

/// Seven beams over 180 deg of a lidar mounted left and turned: returns, a no-return, a lost one.
inline std::shared_ptr<mrpt::obs::CObservation2DRangeScan> scanObject(std::int64_t time_ns,
                                                                      const std::string& label = "LASER",
                                                                      float first_range_m = 1.1F) {
  auto scan = mrpt::obs::CObservation2DRangeScan::Create();
  scan->timestamp = rosStamp(time_ns);
  scan->sensorLabel = label;
  scan->rightToLeft = true;
  scan->aperture = 3.1415927F;
  scan->maxRange = 30;
  scan->sensorPose = mrpt::poses::CPose3D(0.25, -0.125, 0.3, 0.1, 0, 0);
  const std::vector<float> ranges{first_range_m, 2.2F, 30.0F, 0.0F, 5.5F, 0.0123F, 29.99F};
  scan->resizeScan(ranges.size());
  for (size_t i = 0; i < ranges.size(); ++i) {
    scan->setScanRange(i, ranges[i]);
    scan->setScanRangeValidity(i, i != 2 && i != 3);
  }
  return scan;
}

inline std::shared_ptr<mrpt::obs::CObservationOdometry> odometryObject(std::int64_t time_ns, double x_m,
                                                                       double phi_rad) {
  auto odometry = mrpt::obs::CObservationOdometry::Create();
  odometry->timestamp = rosStamp(time_ns);
  odometry->sensorLabel = "ODOMETRY";
  odometry->odometry = mrpt::poses::CPose2D(x_m, -0.7 * x_m, phi_rad);
  return odometry;
}

inline std::shared_ptr<mrpt::obs::CObservationRobotPose> truthObject(std::int64_t time_ns, double x_m) {
  auto truth = mrpt::obs::CObservationRobotPose::Create();
  truth->timestamp = rosStamp(time_ns);
  truth->sensorLabel = objects::kTruthLabel;
  truth->pose.mean = mrpt::poses::CPose3D(x_m, 2, 0, -2.5, 0, 0);
  return truth;
}

/// Odometry, truth and a scan at each of `count` moments 0.2 s apart.
inline std::vector<Object> drive(int count) {
  std::vector<Object> objects;
  for (int i = 0; i < count; ++i) {
    const std::int64_t time_ns = kRosStart_ns + std::int64_t{200'000'000} * i;
    objects.push_back(odometryObject(time_ns, 0.1 * i, 0.05 * i - 3));
    objects.push_back(truthObject(time_ns, 0.11 * i));
    objects.push_back(scanObject(time_ns, "scan", 1.1F + 0.001F * static_cast<float>(i)));
  }
  return objects;
}

inline std::vector<Object> readAll(objects::ObjectSource& source) {
  std::vector<Object> objects;
  while (auto object = source.next()) objects.push_back(object);
  return objects;
}

inline void writeAll(const std::vector<Object>& objects, objects::ObjectSink& sink) {
  for (const auto& object : objects) sink.write(*object);
  sink.close();
}

template <class Type>
std::vector<std::shared_ptr<Type>> only(const std::vector<Object>& objects) {
  std::vector<std::shared_ptr<Type>> found;
  for (const auto& object : objects)
    if (auto match = std::dynamic_pointer_cast<Type>(object)) found.push_back(match);
  return found;
}

/// A bag in memory.
class FakeBag {
 public:
  template <class Message>
  FakeBag& add(const std::string& topic, const std::string& type, std::int64_t received_ns,
               const Message& message, bags::RosEncoding encoding = bags::RosEncoding::kCdr) {
    return addBytes({topic, type, encoding, "", ""}, received_ns, bags::encodeRos(encoding, message));
  }
  FakeBag& addBytes(bags::RosChannel channel, std::int64_t received_ns, std::string bytes) {
    records_->push_back({std::move(channel), received_ns, std::move(bytes)});
    return *this;
  }
  std::unique_ptr<objects::ObjectSource> open(const bags::RosReadOptions& options = {}) const {
    return bags::makeRosSource(
        "fake.bag", [records = records_] { return std::make_unique<Messages>(records); }, options);
  }

 private:
  struct Record {
    bags::RosChannel channel;
    std::int64_t received_ns;
    std::string bytes;
  };
  using Records = std::shared_ptr<std::deque<Record>>;
  class Messages : public bags::RosMessages {
   public:
    explicit Messages(Records records) : records_(std::move(records)) {}
    bool next(bags::RosMessage& message) override {
      if (at_ == records_->size()) return false;
      const auto& record = (*records_)[at_++];
      message = {&record.channel, record.received_ns, record.bytes};
      return true;
    }
    double fractionRead() const override { return 0; }

   private:
    Records records_;
    size_t at_ = 0;
  };
  Records records_ = std::make_shared<std::deque<Record>>();
};

inline bags::RosQuaternion turned(double yaw_rad) {
  return {0, 0, std::sin(yaw_rad / 2), std::cos(yaw_rad / 2)};
}
inline bags::RosTransform transform(const std::string& parent, const std::string& child,
                                    bags::RosVector3 translation, bags::RosQuaternion rotation = {}) {
  return {{kRosStart_ns, parent}, child, translation, rotation};
}
inline bags::RosLaserScan laserScan(const std::string& frame, std::vector<float> ranges) {
  bags::RosLaserScan scan;
  scan.header = {kRosStart_ns, frame};
  scan.angle_min = -0.5F;
  scan.angle_max = 0.5F;
  scan.angle_increment = 1.0F / static_cast<float>(ranges.size() - 1);
  scan.range_min = 0.1F;
  scan.range_max = 10;
  scan.ranges = std::move(ranges);
  return scan;
}
inline bags::RosOdometry rosOdometry(std::int64_t time_ns, double x_m,
                                     const std::string& child = "base_link") {
  bags::RosOdometry odometry;
  odometry.header = {time_ns, "odom"};
  odometry.child_frame_id = child;
  odometry.pose = {{x_m, 0, 0}, turned(0.5)};
  return odometry;
}

/// Each container's own writer and reader.
struct Container {
  const char* name;
  const char* file;
  std::function<std::unique_ptr<objects::ObjectSink>(const std::string&)> create;
  std::function<std::unique_ptr<objects::ObjectSource>(const std::string&)> open;
};
inline std::vector<Container> containers() {
  const auto mcap = [](const char* compression, bool ros1) {
    return [=](const std::string& path) {
      bags::McapWriteOptions options;
      options.compression = compression;
      options.ros1 = ros1;
      return bags::createMcap(path, options);
    };
  };
  const auto open_mcap = [](const std::string& path) { return bags::openMcap(path); };
  return {
      {"Ros1Bag", "log.bag", bags::createRos1Bag,
       [](const std::string& path) { return bags::openRos1Bag(path); }},
      {"Ros2Db3", "log.db3", bags::createRos2Db3,
       [](const std::string& path) { return bags::openRos2Db3(path); }},
      {"Ros2Folder", "log", bags::createRos2Db3,
       [](const std::string& path) { return bags::openRos2Folder(path); }},
      {"Mcap", "log.mcap", mcap("none", false), open_mcap},
      {"McapLz4", "log.mcap", mcap("lz4", false), open_mcap},
      {"McapZstd", "log.mcap", mcap("zstd", false), open_mcap},
      {"McapRos1", "log.mcap", mcap("zstd", true), open_mcap},
  };
}

}  // namespace slam::logs
