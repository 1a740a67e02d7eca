#pragma once
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::obstacles {

/// The part of the floor that a sensor looks over at this moment, in the robot frame. An obstacle in it would
/// be seen; so what is remembered there and not seen is no longer there.
class VisibleArea {
 public:
  virtual ~VisibleArea() = default;
  /// False for a point that is not finite.
  virtual bool contains(const core::Point2& p_robot) const = 0;
  /// Its border as a polygon, for pictures: what lies farther than `reach_m` from the sensor is cut off.
  /// Empty when nothing is visible.
  virtual std::vector<core::Point2> outline(double reach_m) const = 0;
};

/// Those of the points that lie in the area, in their order: what an ideal sensor sees of them.
std::vector<core::Point2> pointsWithin(const VisibleArea& area, const std::vector<core::Point2>& p_robot);

/// The original document's robot frame has y ahead and x to the right. Both frames are right-handed with z
/// up, so a turn has the same sign in both: counter-clockwise positive.
inline core::Point2 fromOriginalFrame(const core::Point2& p_original) {
  return {p_original.y, -p_original.x};
}
inline core::Point2 toOriginalFrame(const core::Point2& p_robot) {
  return {-p_robot.y, p_robot.x};
}

}  // namespace slam::obstacles
