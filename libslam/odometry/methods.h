#pragma once
#include "libslam/odometry/scan_odometry.h"

/// What the files of this room share; other rooms use scan_odometry.h.
namespace slam::odometry {

std::unique_ptr<ScanOdometry> makeArgmaxOdometry(const ScanOdometryOptions& options);
std::unique_ptr<ScanOdometry> makeCorrelationOdometry(const ScanOdometryOptions& options);
std::unique_ptr<ScanOdometry> makeRangeFlowOdometry(const ScanOdometryOptions& options);
std::unique_ptr<ScanOdometry> makePlicpOdometry(const ScanOdometryOptions& options);

/// ContractError unless the scan has at least 2 beams and a finite, positive step.
void requireUsable(const lidar::Scan& scan);

/// The motion of the robot between two scans of one lidar (lidar::areOfOneLidar) from that of the lidar: each
/// scan's mounting counts. With the covariance (row-major over x, y, phi, as in ScanMotion) to first order,
/// and the ideal readings.
ScanMotion robotMotion(const lidar::Scan& before, const lidar::Scan& after, const core::Pose2& T_lidar,
                       const std::array<double, 9>& lidar_covariance);
/// False where a standard deviation is so large (0.1 m in the worst direction, 0.05 rad) that the motion is a
/// guess.
bool isMeasurement(const std::array<double, 9>& covariance);

/// The answer to the first scan of all: nothing moved, and that is certain.
ScanMotion noMotionYet();
/// Nothing could be measured: the identity, unreliable, with the search range as standard deviation.
ScanMotion unknownMotion(const ScanOdometryOptions& options);

}  // namespace slam::odometry
