#pragma once
#include <cstdint>
#include <vector>

#include "libslam/paths/path_planner.h"

namespace slam::paths {

/// Lengths of ways between any two places that a planner has reached, not only from the robot.
///
/// Dijkstra's wavefront over square blocks of the planner's nodes. Two blocks are neighbours where a reached
/// node of one is beside a reached node of the other, so nothing leads through a wall: a block is at most
/// kMostBlock_m wide, less than a wall and the room that a robot keeps to it on both sides. 8-connected: up
/// to 8 % above the straight line, and up to a block's side off at each end. Comfort does not count.
class CoarseWays {
 public:
  static constexpr double kMostBlock_m = 0.6;

  /// The blocks are as small as the planner's nodes where there are at most most_blocks of them, else about
  /// that many, or as large as they may be. REQUIRES most_blocks > 0.
  CoarseWays(const PathPlanner& planner, std::size_t most_blocks);
  /// Metres from `from` to each of `to`, infinity where no way leads. REQUIRES reached nodes. Cost: about
  /// 30 ns per block that is nearer than the farthest of `to`.
  std::vector<double> lengths(PathPlanner::Node from, const std::vector<PathPlanner::Node>& to) const;

 private:
  std::size_t blockOf(PathPlanner::Node node) const;

  int node_columns_, side_ = 1, columns_ = 0;
  double block_m_ = 0;
  std::vector<std::uint8_t>
      open_;  ///< per block, with a border: bit d is set where a way leads to neighbour d
};

}  // namespace slam::paths
