#include "libslam/sim/lidar_sensor.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libslam/robot/beam.h"
#include "libslam/world/wall_hit.h"

namespace slam::sim {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double diagonal(const world::Plan& plan) {
  return plan.resolution_m * std::hypot(plan.columns, plan.rows);
}

core::Point2 along(const core::Point2& p, const core::Point2& direction, double length) {
  return {p.x + length * direction.x, p.y + length * direction.y};
}

double castOneRay(const Scene& scene, const core::Point2& p_world, double angle_rad, double max_range_m) {
  thread_local std::vector<float> range_m;
  scene.castScan({p_world.x, p_world.y, angle_rad}, 0, 1, 1, max_range_m, range_m);
  return range_m[0];
}

bool areEqual(const core::Pose2& a, const core::Pose2& b) {
  return a.x == b.x && a.y == b.y && a.phi == b.phi;
}

/// The poses of a lidar at its beams; one when it stood still.
std::vector<core::Pose2> beamPoses(const robot::LidarOptions& options, const core::Pose2& T_world_robot,
                                   const RecentPath& path) {
  const core::Pose2 T_robot_lidar = robot::trueMountingPose(options);
  const auto poseAtBeam = [&](int beam) {
    const double ago_s = options.latency_s + robot::secondsBeforeLastBeam(options, beam);
    return path.poseBefore(T_world_robot, ago_s) * T_robot_lidar;
  };
  std::vector<core::Pose2> poses;
  if (options.sweep > 0)
    for (int beam = 0; beam < options.beams; ++beam) poses.push_back(poseAtBeam(beam));
  else
    poses.push_back(poseAtBeam(0));
  const bool stood_still =
      std::all_of(poses.begin(), poses.end(), [&](const auto& pose) { return areEqual(pose, poses[0]); });
  if (stood_still) poses.resize(1);
  return poses;
}

}  // namespace

LidarSensor::LidarSensor(const robot::LidarOptions& options, std::uint64_t seed)
    : options_(options),
      random_(seed, "lidar"),
      mixed_random_(seed, "lidar mixed"),
      glass_random_(seed, "lidar glass") {
  robot::requireSensible(options);
}

double LidarSensor::memory_s() const {
  return options_.latency_s + options_.sweep / options_.rate_hz;
}

robot::Scan LidarSensor::sense(const Scene& scene, const core::Pose2& T_world_robot, const RecentPath& path,
                               double time_s) {
  robot::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = robot::firstAngle(options_);
  scan.step_rad = robot::beamStep(options_);
  scan.min_range_m = options_.min_range_m;
  scan.max_range_m = options_.max_range_m > 0 ? options_.max_range_m : diagonal(scene.plan());
  scan.range_sigma_m = robot::statedSigma(options_);
  scan.T_robot_lidar = robot::mountingPose(options_);
  T_world_lidar_ = beamPoses(options_, T_world_robot, path);
  if (options_.beam_width_rad > 0)
    castWideBeams(scene, scan.ranges_m);
  else
    castBeams(scene, 0, scan.ranges_m);
  robot::applyLidarErrors(options_, random_, scan.ranges_m);
  return scan;
}

void LidarSensor::castWideBeams(const Scene& scene, std::vector<float>& out_ranges_m) {
  std::array<std::vector<float>, robot::kRaysPerBeam> rays_m;
  for (int ray = 0; ray < robot::kRaysPerBeam; ++ray)
    castBeams(scene, robot::rayOffset(options_, ray), rays_m[static_cast<size_t>(ray)]);
  out_ranges_m.resize(rays_m[0].size());
  for (size_t beam = 0; beam < out_ranges_m.size(); ++beam) {
    std::vector<double> ranges_m;
    for (const auto& ray_m : rays_m) ranges_m.push_back(ray_m[beam]);
    bool mixes = false;
    double where = 0;
    if (options_.mixed_pixels > 0) {
      mixes = mixed_random_.chance(options_.mixed_pixels);
      where = mixed_random_.uniform();
    }
    out_ranges_m[beam] = static_cast<float>(robot::beamRange(ranges_m, mixes, where));
  }
}

void LidarSensor::castBeams(const Scene& scene, double offset_rad, std::vector<float>& out_ranges_m) {
  const double first_rad = robot::firstAngle(options_) + offset_rad, step_rad = robot::beamStep(options_);
  const bool stood_still = T_world_lidar_.size() == 1;
  if (stood_still)
    scene.castScan(T_world_lidar_[0], first_rad, step_rad, options_.beams, options_.max_range_m,
                   out_ranges_m);
  out_ranges_m.resize(static_cast<size_t>(options_.beams));
  const bool has_materials = !scene.plan().materials.empty();
  if (stood_still && !has_materials) return;
  for (size_t beam = 0; beam < out_ranges_m.size(); ++beam) {
    const core::Pose2& T_world_lidar = T_world_lidar_[stood_still ? 0 : beam];
    const core::Point2 p_world = core::position(T_world_lidar);
    const double angle_rad = T_world_lidar.phi + first_rad + static_cast<double>(beam) * step_rad;
    double range_m =
        stood_still ? out_ranges_m[beam] : castOneRay(scene, p_world, angle_rad, options_.max_range_m);
    if (has_materials) range_m = followRay(scene, p_world, angle_rad, range_m);
    out_ranges_m[beam] = static_cast<float>(range_m);
  }
}

double LidarSensor::followRay(const Scene& scene, core::Point2 p_world, double angle_rad, double range_m) {
  // Ranges are floats: this far apart, the scene's answer and the plan's wall are the same place.
  constexpr double kSamePlace = 1e-6;
  constexpr double kLeastCosine = 0.01;
  const world::Plan& plan = scene.plan();
  // So that rounding leaves no ray in the wall that it has just left.
  const double clearance_m = 1e-6 * plan.resolution_m;
  double travelled_m = 0;
  for (int turn = 0; turn < kMostTurns; ++turn) {
    if (std::isinf(range_m)) return kInfinity;
    const core::Point2 direction{std::cos(angle_rad), std::sin(angle_rad)};
    if (world::isPlainAt(plan, along(p_world, direction, range_m))) return travelled_m + range_m;
    const auto hit = world::findWall(plan, p_world, angle_rad);
    const bool is_wall = hit && hit->distance_m <= range_m * (1 + kSamePlace) + kSamePlace;
    const world::Material material = is_wall ? hit->material : world::Material::kPlain;
    const bool has_face = is_wall && (hit->face_x != 0 || hit->face_y != 0);
    const bool ends_here =
        material == world::Material::kPlain || material == world::Material::kDark || !has_face;
    if (ends_here) {
      const bool too_dark = material == world::Material::kDark && options_.dark_range_m > 0 &&
                            travelled_m + range_m > options_.dark_range_m;
      return too_dark ? kInfinity : travelled_m + range_m;
    }
    const auto [normal, steps_m] = world::surfaceAt(plan, *hit);
    // The estimated plane of a wall off the axes may face away from a ray that grazes it.
    const double cosine = std::max(kLeastCosine, -(direction.x * normal.x + direction.y * normal.y));
    bool mirrors = true;
    if (material == world::Material::kGlass) {
      const double incidence_rad = std::acos(std::min(1.0, cosine));
      if (glass_random_.chance(robot::glassEcho(options_, incidence_rad))) return travelled_m + range_m;
      mirrors = glass_random_.chance(robot::glassReflectance(options_, incidence_rad));
    }
    double onward_m = hit->leaves_m + clearance_m;
    if (mirrors) {
      const core::Point2 reflected = along(direction, normal, 2 * cosine);
      const double clear_m = (steps_m + clearance_m) / cosine;
      angle_rad = std::atan2(reflected.y, reflected.x);
      p_world = along(along(p_world, direction, hit->distance_m), reflected, clear_m);
      onward_m = hit->distance_m + clear_m;
    } else {
      p_world = along(p_world, direction, onward_m);
    }
    travelled_m += onward_m;
    if (options_.max_range_m > 0 && travelled_m >= options_.max_range_m) return kInfinity;
    range_m = castOneRay(scene, p_world, angle_rad,
                         options_.max_range_m > 0 ? options_.max_range_m - travelled_m : 0);
  }
  return kInfinity;
}

}  // namespace slam::sim
