#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::oracle {

/// Where a disc can drive on a known plan, as a graph: a node per block of cells that holds a reachable one,
/// at the reachable cell nearest to the block's middle; an edge to each of the 16 nearest blocks (a chess
/// king's and knight's moves) to which the straight line runs through reachable cells. Its lengths are those
/// of real ways, at most 2.7 % above the shortest where nothing stands close by.
///
/// Reachable are the cells that metrics::explorableArea() calls so: their centre has room for the disc, and
/// they are 4-connected with the start's cell or one of its neighbours.
class DriveGraph {
 public:
  using Node = std::int32_t;

  /// `block_cells`: side of a block. Keeps a reference to `plan`. A start in a wall or outside the plan has
  /// one node or none.
  DriveGraph(const world::Plan& plan, const core::Point2& start_world, double radius_m, int block_cells);
  DriveGraph(world::Plan&&, const core::Point2&, double, int) = delete;
  /// The side of a block in cells at which there are at most `most_nodes` of them; at least 2.
  static int blockFor(const world::Plan& plan, std::size_t most_nodes);

  std::size_t size() const { return cell_of_.size(); }
  /// The start's node is the first.
  std::size_t cellOf(Node node) const { return cell_of_[static_cast<std::size_t>(node)]; }
  core::Point2 pointOf(Node node) const;  ///< world frame
  bool isReachable(std::size_t cell) const { return reachable_[cell] != 0; }
  const std::vector<char>& reachable() const { return reachable_; }
  /// The node of the cell's block, -1 for none.
  Node nodeAt(std::size_t cell) const;

  /// Shortest ways from one node to all.
  struct Ways {
    std::vector<float> length_m;     ///< infinity where none leads
    std::vector<std::uint8_t> from;  ///< the edge by which a way comes in; kNoEdge at its begin
  };
  static constexpr std::uint8_t kNoEdge = 255;
  Ways waysFrom(Node node) const;
  /// Only those that are shorter than below_m, one per node; infinity elsewhere.
  Ways waysFrom(Node node, const std::vector<float>& below_m) const;
  /// The nodes of the way to `node`, its begin first. REQUIRES that one leads there.
  std::vector<Node> way(const Ways& ways, Node node) const;
  /// True when the straight line between two places of the world runs through reachable cells only.
  bool seesStraight(const core::Point2& a_world, const core::Point2& b_world) const;

 private:
  Node neighbour(Node node, int edge) const;

  const world::Plan& plan_;
  int block_, blocks_across_, blocks_up_;
  std::vector<char> reachable_;
  std::vector<Node> node_of_block_;
  std::vector<std::size_t> cell_of_;
  std::vector<std::int32_t> edges_;  ///< 16 per node, -1 for none
  std::vector<float> length_m_;      ///< likewise
};

}  // namespace slam::oracle
