#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/obstacles/local_obstacle_map.h"
#include "libslam/obstacles/visible_area.h"

namespace slam::obstacles {

/// The floor around the robot that its sensor has looked over, now or a moment ago: LocalObstacleMap
/// remembers where something is, this where nothing is. What neither of them knows has not been looked at:
/// with a narrow view that is most of what lies around. Without any map or truth.
///
/// Kept as cells of kCell_m in the frame of the poses, which has to stay put; a cell is seen when its centre
/// is. The local zone of LocalObstacleOptions bounds it, and kReach_m: floor that leaves them is forgotten,
/// so drift of the pose does little harm; what is farther away is seen again before the robot is there. Cost
/// of an update: the cells within reach.
class SeenFloor {
 public:
  static constexpr double kCell_m = 0.05, kReach_m = 2;

  explicit SeenFloor(const LocalObstacleOptions& zone = {});

  /// One look, from T_odom_robot: the floor in `visible` and the disc of `stands_on_m` around the robot's
  /// centre, which it fills itself, have been seen. REQUIRES a finite pose (ContractError).
  void update(const core::Pose2& T_odom_robot, const VisibleArea& visible, double stands_on_m);

  /// Whether the cell in which the place lies has been seen.
  bool isSeen(const core::Point2& p_odom) const;
  /// Of the cells whose centres lie within `radius_m` of a place the unseen one nearest to `p_odom_from`;
  /// nothing where all have been seen. Odom frame.
  std::optional<core::Point2> unseenWithin(const core::Point2& p_odom, double radius_m,
                                           const core::Point2& p_odom_from) const;

 private:
  bool isSeen(std::int64_t column, std::int64_t row) const;

  LocalObstacleOptions zone_;
  std::int64_t first_column_ = 0, first_row_ = 0,
               side_ = 0;           ///< of the square window that holds the zone, in cells
  std::vector<std::uint8_t> seen_;  ///< of the window, row by row
};

}  // namespace slam::obstacles
