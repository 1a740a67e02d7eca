#include "libslam/obstacles/seen_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::obstacles {
namespace {

constexpr double kCell_m = SeenFloor::kCell_m, kReach_m = SeenFloor::kReach_m;
constexpr double kFarthest = 1e15;  // cells; a whole number still fits into a double

std::int64_t indexOf(double coordinate_m) {
  return static_cast<std::int64_t>(std::clamp(std::floor(coordinate_m / kCell_m), -kFarthest, kFarthest));
}
core::Point2 centreOf(std::int64_t column, std::int64_t row) {
  return {(static_cast<double>(column) + 0.5) * kCell_m, (static_cast<double>(row) + 0.5) * kCell_m};
}

}  // namespace

SeenFloor::SeenFloor(const LocalObstacleOptions& zone) : zone_(zone) {}

void SeenFloor::update(const core::Pose2& T_odom_robot, const VisibleArea& visible, double stands_on_m) {
  if (!core::isFinite(T_odom_robot)) throw core::ContractError("SeenFloor::update: the pose is not finite");
  const core::Pose2 T_robot_odom = core::inverse(T_odom_robot);
  const core::Point2 p_odom_robot = core::position(T_odom_robot);
  const double half_m =
      std::min(kReach_m, core::hypot(zone_.width_m / 2, std::max(zone_.front_m, zone_.rear_m)));
  SeenFloor after(zone_);
  after.first_column_ = indexOf(p_odom_robot.x - half_m), after.first_row_ = indexOf(p_odom_robot.y - half_m);
  after.side_ = indexOf(2 * half_m) + 2;
  after.seen_.reserve(static_cast<std::size_t>(after.side_ * after.side_));
  for (std::int64_t row = 0; row < after.side_; ++row)
    for (std::int64_t column = 0; column < after.side_; ++column) {
      const std::int64_t at_column = after.first_column_ + column, at_row = after.first_row_ + row;
      const core::Point2 p_robot = T_robot_odom * centreOf(at_column, at_row);
      const double square_m2 = p_robot.x * p_robot.x + p_robot.y * p_robot.y;
      const bool under = square_m2 <= stands_on_m * stands_on_m;
      const bool in_zone = square_m2 <= half_m * half_m && std::abs(p_robot.y) <= zone_.width_m / 2 &&
                           p_robot.x <= zone_.front_m && p_robot.x >= -zone_.rear_m;
      const bool seen = under || (in_zone && (isSeen(at_column, at_row) || visible.contains(p_robot)));
      after.seen_.push_back(seen ? 1 : 0);
    }
  *this = std::move(after);
}

bool SeenFloor::isSeen(std::int64_t column, std::int64_t row) const {
  const std::int64_t x = column - first_column_, y = row - first_row_;
  return x >= 0 && y >= 0 && x < side_ && y < side_ && seen_[static_cast<std::size_t>(y * side_ + x)] != 0;
}

bool SeenFloor::isSeen(const core::Point2& p_odom) const {
  return isSeen(indexOf(p_odom.x), indexOf(p_odom.y));
}

std::optional<core::Point2> SeenFloor::unseenWithin(const core::Point2& p_odom, double radius_m,
                                                    const core::Point2& p_odom_from) const {
  std::optional<core::Point2> nearest;
  double least_m = std::numeric_limits<double>::infinity();
  for (std::int64_t row = indexOf(p_odom.y - radius_m); row <= indexOf(p_odom.y + radius_m); ++row)
    for (std::int64_t column = indexOf(p_odom.x - radius_m); column <= indexOf(p_odom.x + radius_m);
         ++column) {
      const core::Point2 p_odom_centre = centreOf(column, row);
      if (core::distance(p_odom_centre, p_odom) > radius_m || isSeen(column, row)) continue;
      const double distance_m = core::distance(p_odom_centre, p_odom_from);
      if (distance_m < least_m) least_m = distance_m, nearest = p_odom_centre;
    }
  return nearest;
}

}  // namespace slam::obstacles
