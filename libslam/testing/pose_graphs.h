#pragma once
#include <cstdint>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/posegraph/pose_graph.h"

namespace slam::testing {

/// A robot that drives about on a street grid of 5 m and recognises where it is.
struct DrivenGraph {
  posegraph::PoseGraph
      graph;  ///< first node fixed at the origin, the others chained along the noisy odometry
  std::vector<core::Pose2> truth;  ///< by node
};

/// One node per metre; loops to all nodes within 2 m that are at least 20 older. Errors of edges are normal
/// with the covariance that the edges state: 2 cm, 2 cm and 0.5 degrees, times `noise`. The same seed gives
/// the same graph.
DrivenGraph driveOnGrid(int nodes, std::uint64_t seed, double noise = 1);

/// Adds false loops, `share` times as many as the graph has loops, each between two nodes at least 20 apart,
/// anywhere; the measurement is up to 5 m away along each axis, with any heading; the information is that of
/// some true loop. Returns how many. REQUIRES a graph with loops and more than 40 nodes.
int addFalseLoops(posegraph::PoseGraph& graph, double share, core::RandomStream& random);

}  // namespace slam::testing
