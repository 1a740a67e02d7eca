#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"
#include "libslam/world/sector_caster.h"

namespace slam::sim {

/// What stands around the robot at the present moment: what a ray meets and what a body bumps into.
class Scene {
 public:
  /// Keeps a reference to `plan`, which must outlive it and not change.
  explicit Scene(const world::Plan& plan);

  const world::Plan& plan() const { return plan_; }
  /// As world::castScan().
  void castScan(const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad, int beams,
                double max_range_m, std::vector<float>& out_ranges_m) const;
  /// As world::discCollides().
  bool discCollides(const core::Point2& p_world, double radius_m) const;

 private:
  const world::Plan& plan_;
  world::SectorCaster caster_;
};

}  // namespace slam::sim
