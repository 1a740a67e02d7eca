#pragma once
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/paths/planning_ground.h"

namespace slam::paths {

/// Shortest ways from the robot to everywhere: Dijkstra's wavefront (Numerische Mathematik 1, 1959) over
/// 8-connected nodes with integer costs in Dial's circular buckets (Communications of the ACM 12(11), 1969).
///
/// A node stands for node_m x node_m of cells, at that cell of them which is farthest from obstacles, and
/// admits the robot when that cell does. A step costs its length times a factor from 1 (comfort_m and more
/// from obstacles) to 4 (at radius_m). From the admitted nodes that are reached, the wave then runs on
/// through free nodes too narrow for the robot, at most look_m: these are in reach of a look.
///
/// The robot itself may stand where it is not admitted (an inflated wall, an unknown cell): the wave starts
/// at the admitted nodes around the nearest one within 1.5 m that a straight line without occupied cells
/// leads to.
class PathPlanner {
 public:
  using Node = std::int32_t;
  static constexpr std::int32_t kNotReached = std::numeric_limits<std::int32_t>::max();

  /// Keeps a reference to `space`. Cost: see squaredClearance(), and about 20 ns per admitted node.
  PathPlanner(const FreeSpace& space, const PlannerOptions& options, const core::Point2& p_map_robot);
  /// The same on a ground that was made with these options. Keeps a reference to its map.
  PathPlanner(const PlanningGround& ground, const PlannerOptions& options, const core::Point2& p_map_robot);

  /// True when the robot stands at an admitted node or can leave to one.
  bool hasStart() const { return has_start_; }
  Node nodeOf(std::size_t cell) const;
  core::Point2 pointOf(Node node) const { return space_.centreOf(cellOf(node)); }
  /// Reached by driving.
  bool isReached(Node node) const { return cost_[static_cast<std::size_t>(node)] != kNotReached; }
  /// In metres of comfortable driving. REQUIRES isReached(node).
  double cost(Node node) const { return cost_[static_cast<std::size_t>(node)] * unit_m_; }
  /// The reached node from where `node` is in reach of a look (itself when it is reached), if any.
  std::optional<Node> accessOf(Node node) const;
  /// The nodes from the start to `node`. REQUIRES isReached(node).
  std::vector<Node> way(Node node) const;
  /// Metres along `way`, from the robot. 8-connected: up to 8 % above the straight line.
  double length(const std::vector<Node>& way) const;
  /// The same way with every bend left out whose short cut costs no more and keeps radius_m; without the
  /// robot's own place, unless the way ends there.
  std::vector<core::Point2> shortened(const std::vector<Node>& way) const;
  /// Reached nodes.
  std::size_t reachedCount() const { return reached_; }
  /// Nodes are numbered row by row: node = row * nodeColumns() + column, a blocked border included.
  int nodeColumns() const { return columns_; }
  int nodeRows() const { return rows_; }
  double nodeSide_m() const { return per_node_ * space_.resolution_m; }

 private:
  PathPlanner(const FreeSpace& space, std::shared_ptr<const PlanningNodes> nodes,
              const PlannerOptions& options, const core::Point2& p_map_robot);
  std::size_t cellOf(Node node) const;
  void openStart();
  bool passes(Node a, Node b) const;
  std::vector<std::pair<Node, std::int32_t>> startNodes() const;
  void spread();
  void spreadLook();
  double lineCost(const core::Point2& a, const core::Point2& b) const;

  const FreeSpace& space_;
  PlannerOptions options_;
  core::Point2 robot_;
  bool has_start_ = false;
  std::shared_ptr<const PlanningNodes> nodes_;
  int per_node_, columns_, rows_;         ///< as nodes_ has them
  double unit_m_;                         ///< metres of one unit of cost
  std::int16_t tight_;                    ///< squared clearance near the start, as nodes_->admitted
  std::vector<std::uint8_t> factor_;      ///< per node, 0 = not admitted: nodes_' and what the start opens
  std::vector<std::int32_t> cost_;        ///< per node
  std::vector<std::uint8_t> from_;        ///< per node: direction to the node before it
  std::vector<std::uint8_t> look_depth_;  ///< per node beyond the reached ones
  std::size_t reached_ = 0;
};

}  // namespace slam::paths
