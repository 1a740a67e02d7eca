#include "libslam/bags/ros_frames.h"

#include <mrpt/math/CQuaternion.h>

#include <array>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::bags {
namespace {

/// Longer chains than this are loops.
constexpr size_t kLongestChain = 100;

/// "odom", or "<prefix>/odom".
bool isNamed(std::string_view frame, std::string_view name) {
  if (frame == name) return true;
  return frame.size() > name.size() && frame.substr(frame.size() - name.size()) == name &&
         frame[frame.size() - name.size() - 1] == '/';
}

}  // namespace

std::string frameName(std::string_view frame_id) {
  if (!frame_id.empty() && frame_id.front() == '/') frame_id.remove_prefix(1);
  return std::string(frame_id);
}

bool isOdometryFrame(std::string_view frame) {
  return isNamed(frame, "odom") || isNamed(frame, "odom_combined");
}
bool isWorldFrame(std::string_view frame) {
  return isOdometryFrame(frame) || isNamed(frame, "map") || isNamed(frame, "world");
}

std::optional<mrpt::poses::CPose3D> toMrptPose(const RosVector3& position, const RosQuaternion& orientation) {
  const auto& [x, y, z, w] = orientation;
  // A shorter one than this holds no direction: drivers leave it all zero when they do not know it.
  constexpr double kShortest = 1e-6;
  const double length = std::sqrt(x * x + y * y + z * z + w * w);
  if (!(length > kShortest) || !std::isfinite(length)) return std::nullopt;
  for (const double value : {position.x, position.y, position.z})
    if (!std::isfinite(value)) return std::nullopt;
  // A turn about z alone keeps its angle to the last bit but one, which a way through a matrix would not.
  if (x == 0 && y == 0)
    return mrpt::poses::CPose3D(position.x, position.y, position.z, 2 * core::atan2(z, w), 0, 0);
  const mrpt::math::CQuaternionDouble unit(w / length, x / length, y / length, z / length);
  return mrpt::poses::CPose3D(unit, position.x, position.y, position.z);
}

void FrameTree::set(const std::string& parent, const std::string& child,
                    const mrpt::poses::CPose3D& T_parent_child) {
  parents_[child] = {parent, T_parent_child};
}

void FrameTree::setIfNew(const std::string& parent, const std::string& child,
                         const mrpt::poses::CPose3D& T_parent_child) {
  parents_.insert({child, {parent, T_parent_child}});
}

bool FrameTree::has(const std::string& frame) const {
  if (parents_.count(frame)) return true;
  for (const auto& [child, edge] : parents_)
    if (edge.parent == frame) return true;
  return false;
}

std::vector<std::pair<std::string, mrpt::poses::CPose3D>> FrameTree::ancestors(
    const std::string& frame) const {
  std::vector<std::pair<std::string, mrpt::poses::CPose3D>> chain{{frame, mrpt::poses::CPose3D()}};
  while (chain.size() < kLongestChain) {
    const auto found = parents_.find(chain.back().first);
    if (found == parents_.end() || isWorldFrame(found->second.parent)) break;
    // Nothing is composed with the identity, so that a single transform stays what it is to the bit.
    const auto& T_parent_child = found->second.T_parent_child;
    chain.emplace_back(found->second.parent,
                       chain.size() == 1 ? T_parent_child : T_parent_child + chain.back().second);
  }
  return chain;
}

std::optional<mrpt::poses::CPose3D> FrameTree::between(const std::string& base,
                                                       const std::string& frame) const {
  const auto of_base = ancestors(base), of_frame = ancestors(frame);
  for (const auto& [name, T_common_frame] : of_frame) {
    if (name == base) return T_common_frame;
    for (const auto& [other, T_common_base] : of_base)
      if (other == name) return T_common_frame - T_common_base;
  }
  return std::nullopt;
}

}  // namespace slam::bags
