#include "libslam/posegraph/chaining.h"

#include <algorithm>
#include <cmath>
#include <deque>

namespace slam::posegraph {
namespace {

class Chaining {
 public:
  Chaining(const Edges& edges, std::vector<std::optional<core::Pose2>> given)
      : edges_(edges), poses_(given.size()), edges_of_(given.size()) {
    for (size_t i = 0; i < edges.size(); ++i) {
      if (!edges[i].on) continue;
      if (edges[i].from == kMap) {
        if (!given[at(edges[i].to)]) given[at(edges[i].to)] = edges[i].T_from_to;
        continue;
      }
      edges_of_[at(edges[i].from)].push_back(i);
      edges_of_[at(edges[i].to)].push_back(i);
    }
    for (size_t node = 0; node < given.size(); ++node)
      if (given[node]) set(node, *given[node]);
    for (size_t node = 0; node < given.size(); ++node) {
      if (!poses_[node]) {
        spread();
        if (!poses_[node]) set(node, core::Pose2());
      }
    }
    spread();
  }
  std::vector<core::Pose2> poses() const {
    std::vector<core::Pose2> out;
    for (const auto& pose : poses_) out.push_back(*pose);
    return out;
  }

 private:
  static size_t at(int node) { return static_cast<size_t>(node); }
  void set(size_t node, const core::Pose2& pose) {
    poses_[node] = pose;
    for (const size_t edge : edges_of_[node])
      if (edges_[edge].kind == EdgeKind::kOdometry)
        next_.push_front(edge);
      else
        next_.push_back(edge);
  }
  void spread() {
    while (!next_.empty()) {
      const Edge& edge = edges_[next_.front()];
      next_.pop_front();
      const size_t a = at(edge.from), b = at(edge.to);
      if (!poses_[b])
        set(b, *poses_[a] * edge.T_from_to);
      else if (!poses_[a])
        set(a, *poses_[b] * core::inverse(edge.T_from_to));
    }
  }
  const Edges& edges_;
  std::vector<std::optional<core::Pose2>> poses_;
  std::vector<std::vector<size_t>> edges_of_;
  std::deque<size_t> next_;  // edges with at least one end set
};

}  // namespace

std::vector<core::Pose2> chained(const Edges& edges, std::vector<std::optional<core::Pose2>> given) {
  return Chaining(edges, std::move(given)).poses();
}

std::vector<core::Pose2> chained(const PoseGraph& graph) {
  std::vector<std::optional<core::Pose2>> given(static_cast<size_t>(graph.nodeCount()));
  bool is_held = false;
  for (int node = 0; node < graph.nodeCount(); ++node)
    if (graph.isFixed(node)) given[static_cast<size_t>(node)] = graph.pose(node), is_held = true;
  for (const Edge& edge : graph.edges()) is_held = is_held || (edge.on && edge.from == kMap);
  if (!is_held && !given.empty()) given[0] = graph.pose(0);
  return chained(graph.edges(), std::move(given));
}

std::vector<core::Pose2> scattered(const PoseGraph& graph, core::RandomStream random) {
  double extent = 1;
  for (const core::Pose2& pose : chained(graph))
    extent = std::max({extent, std::abs(pose.x), std::abs(pose.y)});
  std::vector<core::Pose2> out;
  for (int node = 0; node < graph.nodeCount(); ++node) {
    const double x = random.uniform(-extent, extent), y = random.uniform(-extent, extent);
    out.push_back({x, y, random.uniform(-core::kPi, core::kPi)});
  }
  return out;
}

void startAt(PoseGraph& graph, const std::vector<core::Pose2>& T_map_node) {
  for (int node = 0; node < graph.nodeCount(); ++node)
    if (!graph.isFixed(node)) graph.setPose(node, T_map_node.at(static_cast<size_t>(node)));
}

}  // namespace slam::posegraph
