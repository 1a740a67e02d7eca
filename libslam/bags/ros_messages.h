#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace slam::bags {

/// The ROS messages that a 2D-lidar log needs, one struct each, and their two wire forms. Fields as in ROS's
/// own definitions (wiki.ros.org/msg, docs.ros.org), SI units and radians; what we never use is not kept.

/// How a message's bytes are laid out: ROS 1 packs little-endian without gaps; ROS 2 uses CDR (OMG DDS-XTypes
/// 1.3, 7.4.1: a 4-byte head names the byte order, every number is aligned to its size).
enum class RosEncoding { kRos1, kCdr };

struct RosHeader {
  std::int64_t stamp_ns = 0;  ///< since the Unix epoch; 0: no stamp
  std::string frame_id;
};

struct RosVector3 {
  double x = 0, y = 0, z = 0;
};
struct RosQuaternion {
  double x = 0, y = 0, z = 0, w = 1;
};
struct RosPose {
  RosVector3 position;
  RosQuaternion orientation;
};

/// sensor_msgs/LaserScan
struct RosLaserScan {
  RosHeader header;
  float angle_min = 0, angle_max = 0, angle_increment = 0;
  float time_increment = 0, scan_time = 0;
  float range_min = 0, range_max = 0;
  std::vector<float> ranges, intensities;
};

/// sensor_msgs/MultiEchoLaserScan: of each beam all echoes, the nearest first.
struct RosMultiEchoLaserScan {
  RosHeader header;
  float angle_min = 0, angle_max = 0, angle_increment = 0;
  float time_increment = 0, scan_time = 0;
  float range_min = 0, range_max = 0;
  std::vector<std::vector<float>> ranges, intensities;
};

/// nav_msgs/Odometry
struct RosOdometry {
  RosHeader header;
  std::string child_frame_id;
  RosPose pose;
  std::array<double, 36> pose_covariance{};
  RosVector3 linear, angular;  ///< in child_frame_id
  std::array<double, 36> twist_covariance{};
};

/// geometry_msgs/PoseStamped
struct RosPoseStamped {
  RosHeader header;
  RosPose pose;
};

/// geometry_msgs/TransformStamped: takes coordinates in child_frame_id to header.frame_id.
struct RosTransform {
  RosHeader header;
  std::string child_frame_id;
  RosVector3 translation;
  RosQuaternion rotation;
};
/// tf2_msgs/TFMessage, and tf/tfMessage, which has the same bytes.
struct RosTransforms {
  std::vector<RosTransform> transforms;
};

/// Bytes to a message and back. Message is one of RosLaserScan, RosMultiEchoLaserScan, RosOdometry,
/// RosPoseStamped, RosTransforms.
/// Decoding: InputError (one line without a place: the caller adds it) for bytes that end too early, lengths
/// that do not fit into the bytes that are left (checked before memory is taken), an unknown CDR head, and
/// bytes left over (CDR: more than 3 of padding). Encoding: CDR little-endian; a stamp outside of what the
/// form can hold (ROS 1: 1970 to 2106, ROS 2: 1901 to 2038) is a ContractError, rosCanHold() says.
template <class Message>
Message decodeRos(RosEncoding encoding, std::string_view bytes);
template <class Message>
std::string encodeRos(RosEncoding encoding, const Message& message);

bool rosCanHold(RosEncoding encoding, std::int64_t stamp_ns);

inline constexpr const char* kLaserScanType = "sensor_msgs/LaserScan";
inline constexpr const char* kMultiEchoType = "sensor_msgs/MultiEchoLaserScan";
inline constexpr const char* kOdometryType = "nav_msgs/Odometry";
inline constexpr const char* kPoseStampedType = "geometry_msgs/PoseStamped";
inline constexpr const char* kTransformsType = "tf2_msgs/TFMessage";
inline constexpr const char* kOldTransformsType = "tf/tfMessage";

/// ROS 1's check sum of a type's definition, "" for a type that we do not know.
std::string rosMd5(std::string_view type);

/// The type's definition followed by those of the types in it, as bags carry it. REQUIRES a known type.
std::string rosDefinition(RosEncoding encoding, std::string_view type);

/// "sensor_msgs/msg/LaserScan" -> "sensor_msgs/LaserScan", and back.
std::string withoutMsg(std::string_view type);
std::string withMsg(std::string_view type);

}  // namespace slam::bags
