#include "libslam/movers/scene.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/rays/original_ray.h"

namespace slam::movers {

Scene::Scene(const world::Plan& plan) : Scene(plan, {}, 0, {}) {}

Scene::~Scene() = default;

Scene::Scene(const world::Plan& plan, const LivingOptions& living, std::uint64_t seed, const Disc& robot)
    : plan_(plan), caster_(plan) {
  if (living.people > 0) crowd_ = std::make_unique<Crowd>(plan, living, seed, toPlanFrame(robot));
  if (living.doors_share > 0 && plan.doors.empty())
    throw core::InputError("plan '" + plan.name + "': section [living], key 'doors_share': found " +
                           files::formatNumber(living.doors_share) +
                           ", expected 0: the plan names no doors (key 'doors' of its yaml)");
  if (living.doors_share > 0) {
    doors_ = std::make_unique<Doors>(plan, living, seed);
    changing_ = std::make_unique<world::Plan>(plan);
  }
  placeBodies();
}

void Scene::castScan(const core::Pose2& T_world_lidar, const rays::BeamTable& beams, double max_range_m,
                     std::vector<float>& out_ranges_m) const {
  caster_.castScan(T_world_lidar, beams, max_range_m, out_ranges_m);
  if (!bodies_.empty())
    movers::castScan(bodies_, T_world_lidar, beams.firstAngle(), beams.step(), max_range_m, out_ranges_m);
}

double Scene::castRay(const core::Point2& p_world, double angle_rad, double max_range_m) const {
  return castBodies(p_world, angle_rad, caster_.castRay(p_world, angle_rad, max_range_m), max_range_m);
}

double Scene::castOriginalRay(const core::Point2& p_world, double angle_rad, double max_range_m) const {
  const double wall_m = rays::castOriginalRay(plan(), p_world, angle_rad, max_range_m);
  const double range_m = castBodies(p_world, angle_rad, wall_m, max_range_m);
  return range_m < wall_m ? std::round(range_m / plan().resolution_m) * plan().resolution_m : wall_m;
}

double Scene::castBodies(const core::Point2& p_world, double angle_rad, double range_m,
                         double max_range_m) const {
  const core::Point2 direction = core::polar(1, angle_rad);
  for (const Disc& body : bodies_) {
    const double body_m = movers::castRay(body, p_world, direction);
    if (body_m < range_m && (max_range_m <= 0 || body_m <= max_range_m)) range_m = body_m;
  }
  return range_m;
}

namespace {

bool overlapsAny(const std::vector<Disc>& discs, const core::Point2& p, double radius_m) {
  return std::any_of(discs.begin(), discs.end(), [&](const Disc& disc) {
    const double dx = disc.p.x - p.x, dy = disc.p.y - p.y;
    const double reach_m = disc.radius_m + radius_m;
    return dx * dx + dy * dy <= reach_m * reach_m;
  });
}

}  // namespace

bool Scene::discCollides(const core::Point2& p_world, double radius_m) const {
  return world::discCollides(plan(), p_world, radius_m) || overlapsAny(persons_, p_world, radius_m);
}

void Scene::setRobots(const std::vector<Disc>& robots) {
  robots_ = robots;
  placeBodies();
}

bool Scene::touchesRobot(const core::Point2& p_world, double radius_m) const {
  return overlapsAny(robots_, p_world, radius_m);
}

void Scene::noteCarried(const Disc& robot) {
  if (crowd_) crowd_->noteCarried(toPlanFrame(robot));
}

void Scene::tick(const Disc& robot) {
  const Disc robot_in_plan = toPlanFrame(robot);
  if (doors_) moveDoors(robot_in_plan);
  if (crowd_) crowd_->tick(robot_in_plan);
  placeBodies();
}

Disc Scene::toPlanFrame(const Disc& robot) const {
  return {core::inverse(plan_.T_frame_raster) * robot.p, robot.radius_m};
}

void Scene::moveDoors(const Disc& robot_in_plan) {
  std::vector<Disc> bodies{robot_in_plan};
  if (crowd_)
    for (const auto& person : crowd_->people()) bodies.push_back({person.p, crowd_->radius_m()});
  // Walkways tell cells apart, not points: one and a half cells more keep everybody where they can stand.
  for (const size_t i : doors_->tick(bodies, 1.5 * plan_.resolution_m)) {
    const auto& door = doors_->all()[i];
    setDoor(door.cells, door.state == DoorState::kClosed ? world::Cell::kOccupied : world::Cell::kFree);
  }
}

void Scene::setDoor(const world::Door& door, world::Cell cell) {
  for (int row = door.y0; row < door.y1; ++row)
    for (int column = door.x0; column < door.x1; ++column)
      changing_->cells[static_cast<size_t>(row) * static_cast<size_t>(changing_->columns) +
                       static_cast<size_t>(column)] = cell;
  caster_.update(*changing_, door.x0, door.y0, door.x1, door.y1);
  if (crowd_) crowd_->update(*changing_, door);
}

void Scene::placeBodies() {
  bodies_ = robots_;
  persons_ = robots_;
  if (!crowd_) return;
  const std::size_t others = robots_.size();
  crowd_->appendBodies(bodies_);
  for (std::size_t i = others; i < bodies_.size(); ++i) bodies_[i].p = plan_.T_frame_raster * bodies_[i].p;
  for (const auto& person : crowd_->people())
    persons_.push_back({plan_.T_frame_raster * person.p, crowd_->radius_m()});
}

}  // namespace slam::movers
