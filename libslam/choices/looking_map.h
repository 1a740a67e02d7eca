#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "libslam/paths/free_space.h"
#include "libslam/paths/frontier.h"

namespace slam::choices {

/// The map in which a robot looks for frontiers: a copy of the newest one with obstacles in frontier cells
/// that are false, kept from decision to decision. Only what has changed is copied and looked at anew.
class LookingMap {
 public:
  /// The newest map. `changed` holds every cell whose state is another than at the call before.
  void update(const paths::FreeSpace& map, const paths::CellBlock& changed);
  /// Puts an obstacle into every frontier cell of the newest map of which `is_false` says so, and then into
  /// gaps in walls of up to gap_m, see paths::closeWalls(); 0 closes none. REQUIRES update() with this map.
  void close(const paths::FreeSpace& map, const std::function<bool(std::size_t cell)>& is_false,
             double gap_m);
  /// What close() has made of it.
  const paths::FreeSpace& space() const { return space_; }
  /// Of space(), ascending.
  const std::vector<std::size_t>& frontierCells() const { return frontier_cells_; }

 private:
  paths::FreeSpace space_;
  paths::FrontierCells of_map_;
  std::vector<std::size_t> frontier_cells_;
  std::vector<std::size_t> closed_;  ///< cells of space_ that are not as in the map
};

}  // namespace slam::choices
