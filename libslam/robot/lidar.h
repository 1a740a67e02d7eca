#pragma once
#include <string>
#include <vector>

#include "libslam/core/parameters.h"
#include "libslam/core/random.h"
#include "libslam/robot/scan.h"

namespace slam::robot {

/// Geometry and errors of a 2D lidar; section [lidar]. Presets are in configs/lidars/.
struct LidarOptions {
  double fov_rad;  ///< first to last beam; 360 degrees means a full circle of `beams` without a doubled beam
  int beams;
  double min_range_m;                          ///< nearer things are not seen (lost reading)
  double max_range_m;                          ///< 0 = no limit
  double sigma_m;                              ///< Gaussian range noise
  double drop_out;                             ///< probability that a reading is lost
  double rate_hz;                              ///< scans per second
  double mount_x_m, mount_y_m, mount_yaw_rad;  ///< T_robot_lidar

  LidarOptions();
  static const core::ParameterTable<LidarOptions>& table();
};

core::Pose2 mountingPose(const LidarOptions& options);
/// Angle between neighbouring beams: fov / (beams - 1), or 2 pi / beams for a full circle.
double beamStep(const LidarOptions& options);
/// Angle of beam 0 in the lidar frame, -fov/2 (a full circle starts at -pi).
double firstAngle(const LidarOptions& options);

/// Turns exact ranges (infinity = nothing hit) into what the sensor reports: limits, noise, drop-outs. Two
/// draws per beam whatever happens, so that the same beam gets the same noise under other options.
void applyLidarErrors(const LidarOptions& options, core::RandomStream& random, std::vector<float>& ranges_m);

}  // namespace slam::robot
