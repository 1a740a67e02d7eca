#pragma once
#include "libslam/calibration/estimate.h"
#include "libslam/calibration/motion_series.h"

namespace slam::calibration {

/// The odometry against scan matching, and where the lidar sits by what it sees while the robot turns.
struct OdometryFit {
  std::size_t windows = 0;            ///< pieces of about half a metre or half a radian that were compared
  double path_m = 0, turned_rad = 0;  ///< by the odometry, over these

  bool has_turns = false;    ///< enough turning for the next one and for the position of the lidar
  Estimate turn_scale;       ///< turn by the odometry over turn by the scans
  bool has_path = false;     ///< enough driving for the next three
  Estimate drift_rad_per_m;  ///< what the odometry turns, per metre, without the scans turning
  Estimate distance_scale;   ///< distance by the odometry over distance by the scans
  Estimate lidar_yaw_rad;    ///< of the lidar on the robot
  bool has_position = false;
  /// Position of the lidar on the robot (the centre of the odometry's turns), in real metres.
  Estimate lidar_x_m, lidar_y_m;
};

/// Windows of consecutive steps that scan matching is sure of, and the odometry over the same time, its
/// stamps shifted by offset_s. Two robust linear fits (iterated reweighted least squares with Cauchy's
/// weights; the intervals from the sandwich covariance, White, Econometrica 48(4), 1980):
///   odometry's turn = scale * scans' turn + drift * distance
///   R(yaw) * lidar's move * scale = odometry's move + (R(turn) - I) * lidar's position * scale
/// the second one being the hand-eye equation of a planar robot (Censi et al., IEEE T-RO 29(2), 2013, eq. 10,
/// where wheel radii are found too).
OdometryFit fitOdometry(const std::vector<Stretch>& stretches, const std::string& stream, double offset_s);

}  // namespace slam::calibration
