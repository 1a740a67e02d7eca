#include "libslam/posegraph/parts.h"

#include <map>
#include <string>

#include "libslam/core/error.h"

namespace slam::posegraph {

void requireHeld(const PoseGraph& graph, const std::vector<char>& is_used) {
  Parts parts(graph);
  for (size_t i = 0; i < graph.edges().size(); ++i)
    if (is_used[i]) parts.join(graph.edges()[i]);
  for (int node = 0; node < graph.nodeCount(); ++node)
    if (!parts.isHeld(node))
      throw core::InputError("pose graph: node " + std::to_string(node) +
                             ": found no chain of edges to a fixed node or a prior, expected one (" +
                             std::to_string(graph.nodeCount()) + " nodes)");
}

std::vector<std::vector<int>> partsOf(const PoseGraph& graph) {
  Parts parts(graph);
  for (const Edge& edge : graph.edges())
    if (edge.on) parts.join(edge);
  std::vector<std::vector<int>> out;
  std::map<int, size_t> index;
  for (int node = 0; node < graph.nodeCount(); ++node) {
    const auto [at, is_new] = index.emplace(parts.nameOf(node), out.size());
    if (is_new) out.emplace_back();
    out[at->second].push_back(node);
  }
  return out;
}

}  // namespace slam::posegraph
