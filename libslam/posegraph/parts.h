#pragma once
#include <numeric>
#include <vector>

#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Which nodes chains of edges connect, edge by edge as they are joined; fixed nodes and the map are one
/// part.
class Parts {
 public:
  explicit Parts(const PoseGraph& graph) : root_(static_cast<size_t>(graph.nodeCount()) + 1) {
    std::iota(root_.begin(), root_.end(), 0);
    for (int node = 0; node < graph.nodeCount(); ++node)
      if (graph.isFixed(node)) unite(node + 1, 0);
  }
  void join(const Edge& edge) { unite(edge.from + 1, edge.to + 1); }
  bool areConnected(const Edge& edge) { return find(edge.from + 1) == find(edge.to + 1); }
  /// One node of the part, the same for all of its nodes; kMap for what is held.
  int nameOf(int node) { return isHeld(node) ? kMap : find(node + 1) - 1; }
  /// To a fixed node or the map.
  bool isHeld(int node) { return find(node + 1) == find(0); }

 private:
  // Element 0 is the map (kMap + 1), element i + 1 node i.
  int find(int i) {
    while (root_[static_cast<size_t>(i)] != i) {
      int& up = root_[static_cast<size_t>(i)];
      up = root_[static_cast<size_t>(up)];
      i = up;
    }
    return i;
  }
  void unite(int a, int b) { root_[static_cast<size_t>(find(a))] = find(b); }
  std::vector<int> root_;
};

/// Nodes that chains of edges that are on connect, ascending, the parts by their smallest node. Fixed nodes
/// and those that have a prior count as connected with one another.
std::vector<std::vector<int>> partsOf(const PoseGraph& graph);

/// Errors: InputError for a node that no chain of used edges ties to a fixed node or to a prior.
void requireHeld(const PoseGraph& graph, const std::vector<char>& is_used);

}  // namespace slam::posegraph
