#pragma once
// For the .cpp files of this room only: it needs MRPT's poses.
#include <mrpt/poses/CPose3D.h>

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "libslam/bags/ros_messages.h"

namespace slam::bags {

/// "/base_link" -> "base_link": ROS 1 once wrote frames with a slash.
std::string frameName(std::string_view frame_id);

/// odom, odom_combined, map, world, with or without a prefix (robot1/odom): frames in which a robot moves.
bool isWorldFrame(std::string_view frame);
/// The first two of them.
bool isOdometryFrame(std::string_view frame);

/// nullopt for a quaternion of length 0 and for numbers that are not finite. A quaternion of another length
/// is normalised.
std::optional<mrpt::poses::CPose3D> toMrptPose(const RosVector3& position, const RosQuaternion& orientation);

/// The newest transform of each frame, as tf keeps it: every child has one parent.
class FrameTree {
 public:
  void set(const std::string& parent, const std::string& child, const mrpt::poses::CPose3D& T_parent_child);
  /// The same, only when the child has no parent yet.
  void setIfNew(const std::string& parent, const std::string& child,
                const mrpt::poses::CPose3D& T_parent_child);
  bool has(const std::string& frame) const;

  /// T_base_frame through parents that both have, never through a frame in which the robot moves; nullopt
  /// when they do not hang together like that.
  std::optional<mrpt::poses::CPose3D> between(const std::string& base, const std::string& frame) const;

 private:
  struct Edge {
    std::string parent;
    mrpt::poses::CPose3D T_parent_child;
  };
  /// The frame's ancestors within the robot, itself first, each with T_ancestor_frame.
  std::vector<std::pair<std::string, mrpt::poses::CPose3D>> ancestors(const std::string& frame) const;

  std::map<std::string, Edge> parents_;  ///< by child
};

}  // namespace slam::bags
