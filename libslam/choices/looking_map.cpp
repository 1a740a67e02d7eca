#include "libslam/choices/looking_map.h"

#include "libslam/paths/close_walls.h"

namespace slam::choices {

void LookingMap::update(const paths::FreeSpace& map, const paths::CellBlock& changed) {
  of_map_.update(map, changed);
  if (space_.columns != map.columns || space_.rows != map.rows) {
    space_ = map;
    closed_.clear();
    return;
  }
  space_.resolution_m = map.resolution_m, space_.known = map.known;
  space_.x_min_m = map.x_min_m, space_.y_min_m = map.y_min_m;
  paths::paste(map, changed, space_);
}

void LookingMap::close(const paths::FreeSpace& map, const std::function<bool(std::size_t cell)>& is_false,
                       double gap_m) {
  for (const std::size_t cell : closed_) space_.state[cell] = map.state[cell];
  closed_.clear();
  for (const std::size_t cell : of_map_.cells())
    if (is_false(cell)) space_.state[cell] = paths::kOccupiedCell, closed_.push_back(cell);
  frontier_cells_ = paths::frontierCellsAmong(space_, of_map_.cells());
  if (!(gap_m > 0)) return;
  const auto walls = paths::closeWalls(space_, frontier_cells_, gap_m);
  closed_.insert(closed_.end(), walls.begin(), walls.end());
  frontier_cells_ = paths::frontierCellsAmong(space_, frontier_cells_);
}

}  // namespace slam::choices
