#pragma once
#include <vector>

#include "libslam/lidar/scan.h"

namespace slam::odometry {

/// The straight line through a return and its neighbours on the same surface.
struct LocalLine {
  bool valid = false;  ///< false: no return, or too few neighbours in a line (pillar's edge, clutter)
  core::Point2 normal;
  double low_m = 0, high_m = 0;       ///< ends of the neighbours along the tangent (-normal.y, normal.x)
                                      ///< from the return
  double normal_variance_per_m2 = 0;  ///< variance of the normal's direction (rad^2) per m^2 of range
                                      ///< variance across the line
};

/// A scan as points with their local lines, in the lidar frame, one per beam.
struct ScanLines {
  double first_angle_rad = 0, step_rad = 0;
  bool full_circle = false;
  double sigma_m = 0;  ///< range noise that the lines were grown with
  std::vector<char> is_return;
  std::vector<core::Point2> points;
  std::vector<LocalLine> lines;
};

/// Grows each line from its return beam by beam to both sides (up to 20 beams each, 1.5 m in all), as long as
/// the beams stay on one surface and the spread about the line stays within the noise. Running sums give the
/// spread of any run of beams at once, so the cost is about that of the beams.
ScanLines findLocalLines(const lidar::Scan& scan);

/// Standard deviation of the ranges, as seen in the scan itself: the median departure of three neighbouring
/// beams from a straight wall. 0 without three neighbouring returns.
double estimateNoise(const lidar::Scan& scan);

/// Unit vectors along the beams, lidar frame.
std::vector<core::Point2> beamDirections(const lidar::Scan& scan);

}  // namespace slam::odometry
