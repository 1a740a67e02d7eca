#include "libslam/sim/scene.h"

namespace slam::sim {

Scene::Scene(const world::Plan& plan) : plan_(plan), caster_(plan) {}

void Scene::castScan(const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad, int beams,
                     double max_range_m, std::vector<float>& out_ranges_m) const {
  caster_.castScan(T_world_lidar, world::BeamTable(first_angle_rad, step_rad, beams), max_range_m,
                   out_ranges_m);
}

bool Scene::discCollides(const core::Point2& p_world, double radius_m) const {
  return world::discCollides(plan_, p_world, radius_m);
}

}  // namespace slam::sim
