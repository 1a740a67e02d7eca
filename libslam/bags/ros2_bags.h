#pragma once
// For the .cpp files of this room only: what the two storages of ROS 2 share.
#include <memory>
#include <string>

#include "libslam/bags/ros_objects.h"

namespace slam::bags {

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
