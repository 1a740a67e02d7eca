#pragma once
#include <optional>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::posegraph {

/// Poses, in the map's frame, for the nodes that have none: along chains of edges from those that do, breadth
/// first and odometry before loops. A prior gives its node the pose that it measures. Where no chain leads,
/// the first node left is put at the origin, and chaining goes on from there. Edges that are off do not
/// count. REQUIRES edges between nodes below given.size().
std::vector<core::Pose2> chained(const Edges& edges, std::vector<std::optional<core::Pose2>> given);

/// The same of a graph, of which only the fixed nodes have a pose; node 0 where there is neither such a node
/// nor a prior.
std::vector<core::Pose2> chained(const PoseGraph& graph);

/// Poses that know nothing, in the map's frame: anywhere in the square round the origin that the chained
/// poses reach into, any heading.
std::vector<core::Pose2> scattered(const PoseGraph& graph, core::RandomStream random);

/// Gives the nodes that are not fixed these poses. REQUIRES one for each node.
void startAt(PoseGraph& graph, const std::vector<core::Pose2>& T_map_node);

}  // namespace slam::posegraph
