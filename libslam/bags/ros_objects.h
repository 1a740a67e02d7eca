#pragma once
// For the .cpp files of this room only: what ROS bags of every container share.
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "libslam/bags/ros_logs.h"
#include "libslam/bags/ros_messages.h"
#include "libslam/objects/object_stream.h"

namespace slam::bags {

/// A topic of a bag.
struct RosChannel {
  std::string topic;  ///< this and the others: shownName()
  std::string type;   ///< without "/msg"
  RosEncoding encoding = RosEncoding::kRos1;
  /// "" for messages that can be decoded, else why not, such as "encoded as json".
  std::string obstacle;
  /// "" or, in a file that says so, the MD5 sum of a definition other than the one that we know.
  std::string other_md5;
};

struct RosMessage {
  const RosChannel* channel = nullptr;
  std::int64_t received_ns = 0;  ///< when the recorder got it
  std::string_view bytes;        ///< until the next message
};

/// The messages of a bag in the order of the file.
class RosMessages {
 public:
  virtual ~RosMessages() = default;
  /// False at the proper end. Errors: InputError with path, place and reason, after the good messages.
  virtual bool next(RosMessage& message) = 0;
  /// 0..1
  virtual double fractionRead() const = 0;
  /// What is missing from a bag that is otherwise read, or "".
  virtual std::string remark() const { return ""; }
};

/// Opens the bag anew, from its start.
using OpenRosMessages = std::function<std::unique_ptr<RosMessages>()>;

/// The objects in the messages, by the rules of ros_logs.h.
std::unique_ptr<objects::ObjectSource> makeRosSource(const std::string& path, OpenRosMessages open,
                                                     const RosReadOptions& options);

/// A bag being written. Channels come in with their first message.
class RosBagWriter {
 public:
  virtual ~RosBagWriter() = default;
  virtual RosEncoding encoding() const = 0;
  /// Times never run back. `is_latched`: a subscriber that comes late gets the last message of the topic.
  virtual void write(const std::string& topic, const std::string& type, bool is_latched, std::int64_t time_ns,
                     std::string_view bytes) = 0;
  virtual void close() = 0;
};

std::unique_ptr<objects::ObjectSink> makeRosSink(std::unique_ptr<RosBagWriter> writer);

/// A name from a file as a message can hold it: core::oneLine() of 200 bytes.
std::string shownName(std::string_view name);

/// "1 message", "3 messages"
std::string counted(std::uint64_t count, const char* singular);

std::unique_ptr<RosMessages> openDb3Messages(const std::string& path);
std::unique_ptr<RosMessages> openMcapMessages(const std::string& path);

/// Of a bag that is a folder: what rosbag2 writes beside its files.
inline constexpr const char* kMetadataName = "metadata.yaml";

/// Quality of service of a latched topic, in rosbag2's YAML: keep last, 1, reliable, transient local, and no
/// deadlines, which are written as the largest duration.
inline constexpr const char* kLatchedQos =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n"
    "  deadline:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  liveliness: 1\n"
    "  liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n"
    "  avoid_ros_namespace_conventions: false";

}  // namespace slam::bags
