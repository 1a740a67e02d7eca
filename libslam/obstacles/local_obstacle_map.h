#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/files/parameters.h"
#include "libslam/obstacles/visible_area.h"

namespace slam::obstacles {

/// Section [obstacles].
struct LocalObstacleOptions {
  double width_m;           ///< W: the zone reaches half of it to either side of the heading axis
  double front_m, rear_m;   ///< L_front and L_rear: how far the zone reaches ahead and behind
  double merge_distance_m;  ///< of two points closer than this one is kept
  int max_points;           ///< most points remembered

  LocalObstacleOptions();
  static const files::ParameterTable<LocalObstacleOptions>& table();
};

/// The obstacles around the robot: those that its camera (or a sector of its lidar) sees now, and those that
/// it saw a moment ago and has turned away from. Points in the robot frame, without any map or truth.
///
/// Each tick, as the original document has it:
///   1. every point is turned by the robot's turn in the opposite sense, then shifted back by the travel
///      (sine and cosine once per tick);
///   2. points that left the local zone are dropped (its border belongs to it);
///   3. points inside the visible area are dropped: what is still there is seen again;
///   4. of two points closer than merge_distance_m the earlier is kept (the document does not say which):
///      what is seen last of a thing that leaves the view would eat it away, distance by distance;
///   5. the obstacles that are seen now are laid over, wherever they are.
///
/// The zone is small on purpose: what odometry has carried astray is soon forgotten. Memory is bounded: after
/// the overlay the oldest points beyond max_points are dropped (of the points of one tick those given first),
/// be they remembered or seen. Cost of a tick: the points, and for step 4 their pairs.
class LocalObstacleMap {
 public:
  explicit LocalObstacleMap(const LocalObstacleOptions& options = {});

  /// One tick. The robot turned by turn_rad (counter-clockwise positive) and then travelled travel_m along
  /// its new heading; `seen` are the obstacles that the sensor sees after it, in the robot frame of then.
  /// Points that are not finite are passed over. REQUIRES a finite motion (ContractError).
  void update(double turn_rad, double travel_m, const VisibleArea& visible,
              const std::vector<core::Point2>& seen);
  /// The same for any planar motion during the tick: an arc, a sideways slip.
  void update(const core::Pose2& T_previous_robot, const VisibleArea& visible,
              const std::vector<core::Point2>& seen);

  /// Oldest first: points()[0 .. rememberedCount()-1] are remembered, the rest is seen now.
  const std::vector<core::Point2>& points() const { return points_; }
  size_t rememberedCount() const { return remembered_; }
  void clear();
  /// Whether the local zone, whose border belongs to it, has room for it.
  bool isInZone(const core::Point2& p_robot) const;

 private:
  void tick(double cosine, double sine, const core::Point2& shift_back, const VisibleArea& visible,
            const std::vector<core::Point2>& seen);

  LocalObstacleOptions options_;
  std::vector<core::Point2> points_;
  size_t remembered_ = 0;
};

}  // namespace slam::obstacles
