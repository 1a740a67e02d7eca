#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "libslam/paths/free_space.h"

namespace slam::paths {

/// How near to obstacles a path may lead.
struct PlannerOptions {
  double radius_m = 0.35;   ///< the centre never comes nearer to an obstacle than this
  double comfort_m = 0.65;  ///< nearer than this a path costs more, so that doors are passed in their middle
  double node_m = 0.1;      ///< spacing of the planning nodes, at least one cell
  double look_m = 1.0;      ///< how far beyond the places that admit the robot free cells count as in reach
  bool optimistic = false;  ///< unknown cells are no obstacles
  /// Within 1.5 m of the robot the way may lead a cell nearer to obstacles than radius_m, at the dearest
  /// factor: a robot that came to where it stands can leave again, though the noisy map has closed in on it.
  bool tight_start = false;
};

/// Least squared distance of centres, in cells, at which a disc of radius_m clears the obstacle cell's square
/// when it meets one of its sides.
std::int16_t clearingSquare(double radius_m, double resolution_m);

/// The planning nodes of a map: all that PathPlanner needs but where the robot is. A node stands for
/// node_m x node_m of cells, at that cell of them which is farthest from obstacles.
struct PlanningNodes {
  static constexpr int kOne = 4, kDearest = 4 * kOne;  ///< cost factors, in quarters

  PlanningNodes() = default;
  /// Errors: ContractError unless 0 < radius_m <= comfort_m and 0 < node_m. Cost: see squaredClearance(), and
  /// about 2 ns per cell.
  PlanningNodes(const FreeSpace& space, const PlannerOptions& options);
  /// Works out anew what the cells of this block change; the rest is that of a map which is the same outside
  /// of it.
  void refresh(const FreeSpace& space, const CellBlock& changed);
  /// Whether these are the nodes of such a map with such options, whatever its cells are.
  bool suits(const FreeSpace& space, const PlannerOptions& options) const;

  int columns = 0, rows = 0;               ///< of nodes, with a blocked border
  int per_node = 1;                        ///< cells along a node's side
  std::int16_t admitted = 0, comfort = 0;  ///< squared clearances in cells
  std::vector<std::int16_t> clearance;     ///< per cell
  std::vector<std::uint8_t> factor_of;     ///< cost factor by squared clearance; 0 = not admitted
  std::vector<std::uint8_t> factor;        ///< per node, 0 = not admitted
  std::vector<std::uint8_t> best_cell;     ///< per node, row by row in the node
  std::vector<std::uint8_t> is_free;       ///< per node: 1 where its best cell is free, 0 at the border

 private:
  void makeNodes(const FreeSpace& space, const CellBlock& block);

  int cell_columns_ = 0, cell_rows_ = 0, reach_ = 0;
  std::uint8_t obstacles_ = 0;
};

/// A map to drive by, kept from decision to decision: the gaps between far beams closed (see closeGaps()),
/// and its planning nodes. Only what lies near cells that have changed since is worked out anew, so that the
/// cost does not grow with the map; the result is always that of the whole.
class PlanningGround {
 public:
  /// The newest map. Cost: about 0.2 ns per cell, and what the block of all changes costs.
  void update(const FreeSpace& map, const PlannerOptions& options);
  /// With its gaps closed. REQUIRES update(); changes with the next one.
  const FreeSpace& space() const { return space_; }
  /// Stay as they are when the ground changes.
  std::shared_ptr<const PlanningNodes> nodes() const { return nodes_; }

 private:
  FreeSpace map_, space_;
  std::shared_ptr<PlanningNodes> nodes_;
};

}  // namespace slam::paths
