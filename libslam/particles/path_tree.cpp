#include "libslam/particles/path_tree.h"

#include <algorithm>

namespace slam::particles {

PathTree::Id PathTree::extend(Id before, const core::StampedPose& pose) {
  if (free_.empty()) {
    free_.push_back(static_cast<Id>(nodes_.size()));
    nodes_.emplace_back();
  }
  const Id leaf = free_.back();
  free_.pop_back();
  nodes_[static_cast<size_t>(leaf)] = {pose, before, 1};
  return leaf;
}

PathTree::Id PathTree::share(Id leaf) {
  if (leaf != kNone) ++nodes_[static_cast<size_t>(leaf)].holders;
  return leaf;
}

void PathTree::release(Id leaf) {
  while (leaf != kNone && --nodes_[static_cast<size_t>(leaf)].holders == 0) {
    free_.push_back(leaf);
    leaf = nodes_[static_cast<size_t>(leaf)].before;
  }
}

core::Trajectory PathTree::path(Id leaf) const {
  core::Trajectory path;
  for (; leaf != kNone; leaf = nodes_[static_cast<size_t>(leaf)].before)
    path.push_back(nodes_[static_cast<size_t>(leaf)].pose);
  std::reverse(path.begin(), path.end());
  return path;
}

}  // namespace slam::particles
