#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"

namespace slam::odometry {

// Scans as range flow odometry compares them (range_flow_odometry.cpp names the paper).

/// Neighbours on one surface may be seen at up to about 83 degrees.
inline constexpr double kSteepest = 8;

/// A scan on equidistant beams as inverse ranges, 0 where nothing is known. Along a straight wall the inverse
/// range is a sinusoid of the angle, so interpolation and differences are exact on walls.
struct Level {
  double first_angle_rad = 0, step_rad = 0;
  bool full_circle = false;
  std::vector<core::Point2> directions;
  std::vector<double> inverse_range;

  size_t size() const { return inverse_range.size(); }
};

/// A scan at all resolutions, finest first.
struct Pyramid {
  std::vector<Level> levels;
  double sigma_m = 0;
};

Pyramid makePyramid(const lidar::Scan& scan);

/// The level as it would look from T_reference_moving^-1 of where it was taken, on the beams of `reference`:
/// the paper's warping. Between neighbours on one surface the inverse range is interpolated; of two surfaces
/// on one beam the nearer one is seen.
void warp(const Level& moving, const core::Pose2& T_reference_moving, const Level& reference, double sigma_m,
          std::vector<double>& warped);

}  // namespace slam::odometry
