#include "libslam/sim/camera_sensor.h"

namespace slam::sim {
namespace {

robot::FloorCamera sensible(const robot::FloorCamera& camera) {
  robot::requireSensible(camera);
  return camera;
}

}  // namespace

CameraSensor::CameraSensor(const robot::FloorCamera& camera, std::uint64_t seed)
    : camera_(sensible(camera)),
      lidar_(robot::asLidar(camera_)),
      beams_(lidar::firstAngle(lidar_), lidar::beamStep(lidar_), lidar_.beams),
      random_(seed, "camera") {}

lidar::Scan CameraSensor::sense(const movers::Scene& scene, const core::Pose2& T_world_robot, double time_s) {
  lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = beams_.firstAngle();
  scan.step_rad = beams_.step();
  scan.min_range_m = lidar_.min_range_m;
  scan.max_range_m = lidar_.max_range_m;
  scan.range_sigma_m = lidar::statedSigma(lidar_);
  scan.T_robot_lidar = lidar::mountingPose(lidar_);
  scene.castScan(T_world_robot * scan.T_robot_lidar, beams_, 0, scan.ranges_m);
  robot::applyCameraErrors(camera_, random_, scan.ranges_m);
  return scan;
}

}  // namespace slam::sim
