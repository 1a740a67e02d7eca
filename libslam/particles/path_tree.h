#pragma once
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::particles {

/// The pasts of many particles that share their beginnings: a tree in which every pose knows the one before.
/// What no particle descends from any more is given back at once, so that the size is that of the living
/// branches. Cost: 40 bytes a pose; extend() and share() constant, release() per pose given back, path() per
/// pose.
class PathTree {
 public:
  using Id = std::int32_t;
  static constexpr Id kNone = -1;

  /// A new leaf after `before` (or kNone: a new root), which it replaces: the caller's hold moves to the
  /// leaf.
  Id extend(Id before, const core::StampedPose& pose);
  /// One more holder of the same leaf; kNone stays kNone.
  Id share(Id leaf);
  void release(Id leaf);
  /// From the root to the leaf.
  core::Trajectory path(Id leaf) const;
  const core::StampedPose& pose(Id node) const { return nodes_[static_cast<size_t>(node)].pose; }
  /// kNone: it is a root.
  Id before(Id node) const { return nodes_[static_cast<size_t>(node)].before; }
  /// Poses alive.
  size_t size() const { return nodes_.size() - free_.size(); }
  size_t bytes() const { return nodes_.capacity() * sizeof(Node) + free_.capacity() * sizeof(Id); }

 private:
  struct Node {
    core::StampedPose pose;
    Id before = kNone;
    std::int32_t holders = 0;  ///< particles and poses after it
  };
  std::vector<Node> nodes_;
  std::vector<Id> free_;
};

}  // namespace slam::particles
