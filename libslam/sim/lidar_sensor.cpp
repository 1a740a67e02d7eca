#include "libslam/sim/lidar_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"
#include "libslam/lidar/beam.h"

namespace slam::sim {
namespace {

using core::kInfinity;

double diagonal(const world::Plan& plan) {
  return plan.resolution_m * core::hypot(plan.columns, plan.rows);
}

core::Point2 along(const core::Point2& p, const core::Point2& direction, double length) {
  return {p.x + length * direction.x, p.y + length * direction.y};
}

/// The wall that a ray met after range_m if it is not plain; nullopt for plain walls, for what is not in the
/// plan, and for a ray that starts in the wall.
std::optional<rays::WallHit> specialWall(const world::Plan& plan, const LidarSensor::Ray& ray,
                                         double range_m) {
  // Ranges are floats: this far apart, the scene's answer and the plan's wall are the same place.
  constexpr double kSamePlace = 1e-6;
  if (rays::isPlainAt(plan, along(ray.p_world, ray.direction(), range_m))) return std::nullopt;
  const auto wall = rays::findWall(plan, ray.p_world, ray.angle_rad);
  const bool is_met = wall && wall->distance_m <= range_m * (1 + kSamePlace) + kSamePlace;
  if (!is_met || wall->material == world::Material::kPlain) return std::nullopt;
  const bool starts_inside = wall->face_x == 0 && wall->face_y == 0;
  if (starts_inside && wall->material != world::Material::kDark) return std::nullopt;
  return wall;
}

/// The poses of a lidar at its beams; one when it stood still.
std::vector<core::Pose2> beamPoses(const lidar::LidarOptions& options, const core::Pose2& T_world_robot,
                                   const RecentPath& path) {
  const core::Pose2 T_robot_lidar = lidar::trueMountingPose(options);
  const auto poseAtBeam = [&](int beam) {
    const double ago_s = options.latency_s + lidar::secondsBeforeLastBeam(options, beam);
    return path.poseBefore(T_world_robot, ago_s) * T_robot_lidar;
  };
  std::vector<core::Pose2> poses;
  if (options.sweep > 0)
    for (int beam = 0; beam < options.beams; ++beam) poses.push_back(poseAtBeam(beam));
  else
    poses.push_back(poseAtBeam(0));
  const bool stood_still =
      std::all_of(poses.begin(), poses.end(), [&](const auto& pose) { return pose == poses[0]; });
  if (stood_still) poses.resize(1);
  return poses;
}

}  // namespace

core::Point2 LidarSensor::Ray::direction() const {
  return core::polar(1, angle_rad);
}

LidarSensor::LidarSensor(const lidar::LidarOptions& options, std::uint64_t seed, const std::string& name)
    : options_(options),
      random_(seed, name),
      mixed_random_(seed, name + " mixed"),
      glass_random_(seed, name + " glass") {
  lidar::requireSensible(options);
  const int rays = options.beam_width_rad > 0 ? lidar::kRaysPerBeam : 1;
  for (int ray = 0; ray < rays; ++ray) {
    const double offset_rad = rays > 1 ? lidar::rayOffset(options, ray) : 0;
    beams_.emplace_back(lidar::firstAngle(options) + offset_rad, lidar::beamStep(options), options.beams);
  }
}

double LidarSensor::memory_s() const {
  return options_.latency_s + options_.sweep / options_.rate_hz;
}

lidar::Scan LidarSensor::sense(const movers::Scene& scene, const core::Pose2& T_world_robot,
                               const RecentPath& path, double time_s) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = lidar::firstAngle(options_);
  scan.step_rad = lidar::beamStep(options_);
  scan.min_range_m = options_.min_range_m;
  scan.max_range_m = options_.max_range_m > 0 ? options_.max_range_m : diagonal(scene.plan());
  scan.range_sigma_m = lidar::statedSigma(options_);
  scan.T_robot_lidar = lidar::mountingPose(options_);
  T_world_lidar_ = beamPoses(options_, T_world_robot, path);
  if (options_.beam_width_rad > 0)
    castWideBeams(scene, scan.ranges_m);
  else
    castBeams(scene, beams_[0], scan.ranges_m);
  lidar::applyLidarErrors(options_, random_, scan.ranges_m);
  return scan;
}

void LidarSensor::castWideBeams(const movers::Scene& scene, std::vector<float>& out_ranges_m) {
  std::array<std::vector<float>, lidar::kRaysPerBeam> rays_m;
  for (int ray = 0; ray < lidar::kRaysPerBeam; ++ray)
    castBeams(scene, beams_[static_cast<size_t>(ray)], rays_m[static_cast<size_t>(ray)]);
  out_ranges_m.resize(rays_m[0].size());
  for (size_t beam = 0; beam < out_ranges_m.size(); ++beam) {
    std::vector<double> ranges_m;
    ranges_m.reserve(rays_m.size());
    for (const auto& ray_m : rays_m) ranges_m.push_back(ray_m[beam]);
    bool mixes = false;
    double where = 0;
    if (options_.mixed_pixels > 0) {
      mixes = mixed_random_.chance(options_.mixed_pixels);
      where = mixed_random_.uniform();
    }
    out_ranges_m[beam] = static_cast<float>(lidar::beamRange(ranges_m, mixes, where));
  }
}

void LidarSensor::castBeams(const movers::Scene& scene, const rays::BeamTable& beams,
                            std::vector<float>& out_ranges_m) {
  const bool stood_still = T_world_lidar_.size() == 1;
  if (options_.ray == "original") return castOriginalBeams(scene, beams, out_ranges_m);
  if (stood_still) scene.castScan(T_world_lidar_[0], beams, options_.max_range_m, out_ranges_m);
  out_ranges_m.resize(static_cast<size_t>(options_.beams));
  const bool has_materials = !scene.plan().materials.empty();
  if (stood_still && !has_materials) return;
  for (size_t beam = 0; beam < out_ranges_m.size(); ++beam) {
    const core::Pose2& T_world_lidar = T_world_lidar_[stood_still ? 0 : beam];
    const core::Point2 p_world = core::position(T_world_lidar);
    const double angle_rad =
        T_world_lidar.phi + beams.firstAngle() + static_cast<double>(beam) * beams.step();
    double range_m =
        stood_still ? out_ranges_m[beam] : scene.castRay(p_world, angle_rad, options_.max_range_m);
    if (has_materials) range_m = followRay(scene, {p_world, angle_rad, 0}, range_m);
    out_ranges_m[beam] = static_cast<float>(range_m);
  }
}

void LidarSensor::castOriginalBeams(const movers::Scene& scene, const rays::BeamTable& beams,
                                    std::vector<float>& out_ranges_m) const {
  out_ranges_m.resize(static_cast<size_t>(options_.beams));
  for (size_t beam = 0; beam < out_ranges_m.size(); ++beam) {
    const core::Pose2& T_world_lidar = T_world_lidar_[T_world_lidar_.size() == 1 ? 0 : beam];
    const double angle_rad =
        T_world_lidar.phi + beams.firstAngle() + static_cast<double>(beam) * beams.step();
    out_ranges_m[beam] = static_cast<float>(
        scene.castOriginalRay(core::position(T_world_lidar), angle_rad, options_.max_range_m));
  }
}

double LidarSensor::followRay(const movers::Scene& scene, Ray ray, double range_m) {
  for (int turn = 0; turn < kMostTurns; ++turn) {
    if (std::isinf(range_m)) return kInfinity;
    const double way_m = ray.travelled_m + range_m;
    const auto wall = specialWall(scene.plan(), ray, range_m);
    if (!wall) return way_m;
    if (wall->material == world::Material::kDark)
      return options_.dark_range_m > 0 && way_m > options_.dark_range_m ? kInfinity : way_m;
    const auto onward = sendOn(scene.plan(), ray, *wall);
    if (!onward) return way_m;
    ray = *onward;
    if (options_.max_range_m > 0 && ray.travelled_m >= options_.max_range_m) return kInfinity;
    range_m = scene.castRay(ray.p_world, ray.angle_rad,
                            options_.max_range_m > 0 ? options_.max_range_m - ray.travelled_m : 0);
  }
  return kInfinity;
}

std::optional<LidarSensor::Ray> LidarSensor::sendOn(const world::Plan& plan, const Ray& ray,
                                                    const rays::WallHit& wall) {
  constexpr double kLeastCosine = 0.01;
  const core::Point2 direction = ray.direction();
  const auto [normal, steps_m] = rays::surfaceAt(plan, wall);
  // The estimated plane of a wall off the axes may face away from a ray that grazes it.
  const double cosine = std::max(kLeastCosine, -(direction.x * normal.x + direction.y * normal.y));
  // So that rounding leaves no ray in the wall that it has just left.
  const double clearance_m = 1e-6 * plan.resolution_m;
  if (wall.material == world::Material::kGlass) {
    const double incidence_rad = core::acos(std::min(1.0, cosine));
    if (glass_random_.chance(lidar::glassEcho(options_, incidence_rad))) return std::nullopt;
    if (!glass_random_.chance(lidar::glassReflectance(options_, incidence_rad))) {
      const double through_m = wall.leaves_m + clearance_m;
      return Ray{along(ray.p_world, direction, through_m), ray.angle_rad, ray.travelled_m + through_m};
    }
  }
  const core::Point2 reflected = along(direction, normal, 2 * cosine);
  const double clear_m = (steps_m + clearance_m) / cosine;
  const core::Point2 p_world_hit = along(ray.p_world, direction, wall.distance_m);
  return Ray{along(p_world_hit, reflected, clear_m), core::atan2(reflected.y, reflected.x),
             ray.travelled_m + wall.distance_m + clear_m};
}

}  // namespace slam::sim
