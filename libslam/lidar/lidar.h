#pragma once
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/files/parameters.h"
#include "libslam/lidar/scan.h"

namespace slam::lidar {

/// Geometry and errors of a 2D lidar; section [lidar]. Presets are in configs/lidars/. The rows from
/// sigma_share on are off at their defaults, but for the glass_ ones, which only matter to plans with glass.
struct LidarOptions {
  double fov_rad;  ///< first to last beam; 360 degrees means a full circle of `beams` without a doubled beam
  int beams;
  double min_range_m;                          ///< nearer things are not seen (lost reading)
  double max_range_m;                          ///< 0 = no limit
  double sigma_m;                              ///< Gaussian range noise
  double drop_out;                             ///< probability that a reading is lost
  double rate_hz;                              ///< scans per second
  double mount_x_m, mount_y_m, mount_yaw_rad;  ///< T_robot_lidar, as the scans state it
  double sigma_share;                          ///< range noise as a share of the range: see rangeSigma()
  double quantum_m;                            ///< readings are multiples of it; 0 = any number
  double beam_width_rad;                       ///< full angle of the cone of one beam
  double mixed_pixels;                         ///< probability that a beam split by an edge mixes both sides
  double sweep;          ///< share of the period that one sweep takes, the robot driving on; 0 = all at once
  bool sweep_clockwise;  ///< the last beam of the scan is measured first
  double latency_s;      ///< the stamp is later than the last beam by so much
  double mount_error_x_m, mount_error_y_m, mount_error_yaw_rad;  ///< where it really sits, less mount_*
  double dark_range_m;       ///< farthest dark surface that answers; 0 = as any other
  double glass_echo;         ///< probability that glass answers a beam head on: see glassEcho()
  double glass_echo_rad;     ///< incidence at which that has fallen to a half
  double glass_reflectance;  ///< of a pane head on: see glassReflectance()
  std::string ray;           ///< exact | original: how the plan is cast, see rays/original_ray.h

  LidarOptions();
  static const files::ParameterTable<LidarOptions>& table();
};

/// InputError for options that are each in bounds but contradict each other: min_range_m or quantum_m not
/// below a max_range_m.
void requireSensible(const LidarOptions& options);

/// Where the scans say that the lidar sits, T_robot_lidar.
core::Pose2 mountingPose(const LidarOptions& options);
/// Where it sits: mountingPose() with the mounting error added coordinate by coordinate, in the robot's
/// frame.
core::Pose2 trueMountingPose(const LidarOptions& options);
/// Angle between neighbouring beams: fov / (beams - 1), or 2 pi / beams for a full circle.
double beamStep(const LidarOptions& options);
/// Angle of beam 0 in the lidar frame, -fov/2 (a full circle starts at -pi).
double firstAngle(const LidarOptions& options);

/// Standard deviation of a reading at a range: the larger of sigma_m and sigma_share * range_m. It says what
/// data sheets say: "10 mm, and 1 % of the distance beyond 1 m" is sigma_m = 0.01, sigma_share = 0.01.
double rangeSigma(const LidarOptions& options, double range_m);
/// The one number that a scan states (Scan::range_sigma_m): that at 3 m, a usual distance indoors, so sigma_m
/// for a lidar whose noise does not grow.
double statedSigma(const LidarOptions& options);

/// When a beam is measured, in seconds before the scan's last one: the sweep of sweep / rate_hz is shared out
/// evenly among the beams, so that a sweep of 1 goes on in the next scan without a gap.
double secondsBeforeLastBeam(const LidarOptions& options, int beam);

/// Turns exact ranges (infinity = nothing hit) into what the sensor reports: limits, noise, drop-outs, then
/// the nearest multiple of quantum_m. Two draws per beam whatever happens, so that the same beam gets the
/// same noise under other options. A reading that would be 0 or less is lost; none reaches max_range_m.
void applyLidarErrors(const LidarOptions& options, core::RandomStream& random, std::vector<float>& ranges_m);

}  // namespace slam::lidar
