#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/lidar/lidar.h"
#include "libslam/lidar/scan.h"
#include "libslam/movers/scene.h"
#include "libslam/rays/wall_hit.h"
#include "libslam/sim/recent_path.h"

namespace slam::sim {

/// A 2D lidar on the robot: whole scans of a scene, with every error of lidar::LidarOptions.
///
/// Time. A scan that sense() stamps with t was measured up to t - latency_s: its last beam then, each other
/// lidar::secondsBeforeLastBeam() earlier, each from where the robot truly was. So the true pose at a scan's
/// stamp is where the robot was latency_s after its last beam, the odometry that is logged with it is of the
/// stamp too, and subtracting latency_s from the stamps of the scans puts all right. What moves in the scene
/// is seen as it stands at the stamp. Before its first command the robot has stood still.
///
/// Place. Beams start where the lidar truly sits; the scan states the mounting pose that it was meant to
/// have.
///
/// Width. With a beam_width_deg each beam is lidar::kRaysPerBeam rays that lidar::beamRange() makes one of.
///
/// Materials, where the plan has some: a mirror sends the ray on about the wall's normal
/// (rays::surfaceAt()), glass answers, mirrors or lets through as lidar::glassEcho() and
/// lidar::glassReflectance() draw it, for each ray anew; a range is the length of the whole way. Transmission
/// does not bend or weaken. The way of a ray ends at its kMostTurns-th pane or mirror: no return. Dark
/// surfaces beyond dark_range_m give none. A mirror that a pane touches from behind is a wall to rays through
/// the pane. What is in the scene and not in its plan is plain.
///
/// Rays: exact, or with ray = original as rays::castOriginalRay(); to that one all materials are plain.
///
/// Streams: the name, "lidar" (as lidar::applyLidarErrors()), with " mixed" and with " glass". Effects that
/// are off neither draw nor cost.
class LidarSensor {
 public:
  static constexpr int kMostTurns = 16;

  /// On its way, after travelled_m of it.
  struct Ray {
    core::Point2 p_world;
    double angle_rad;
    double travelled_m;
    core::Point2 direction() const;
  };

  /// InputError as lidar::requireSensible().
  LidarSensor(const lidar::LidarOptions& options, std::uint64_t seed, const std::string& name = "lidar");

  /// How long ago the oldest beam of a scan was measured, for the RecentPath that sense() is given.
  double memory_s() const;
  /// A lidar without a maximum range states the plan's diagonal as Scan::max_range_m.
  lidar::Scan sense(const movers::Scene& scene, const core::Pose2& T_world_robot, const RecentPath& path,
                    double time_s);

 private:
  void castBeams(const movers::Scene& scene, const rays::BeamTable& beams, std::vector<float>& out_ranges_m);
  void castOriginalBeams(const movers::Scene& scene, const rays::BeamTable& beams,
                         std::vector<float>& out_ranges_m) const;
  void castWideBeams(const movers::Scene& scene, std::vector<float>& out_ranges_m);
  /// The length of the whole way of a ray that meets something after range_m.
  double followRay(const movers::Scene& scene, Ray ray, double range_m);
  /// Past a pane or off a mirror; nullopt when a pane answers.
  std::optional<Ray> sendOn(const world::Plan& plan, const Ray& ray, const rays::WallHit& wall);

  lidar::LidarOptions options_;
  core::RandomStream random_, mixed_random_, glass_random_;
  std::vector<rays::BeamTable> beams_;      ///< one for each ray of a beam
  std::vector<core::Pose2> T_world_lidar_;  ///< of the present scan: one for each beam, or one for all
};

}  // namespace slam::sim
