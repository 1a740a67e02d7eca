#pragma once
#include "libslam/odometry/scan_odometry.h"

/// What the files of this room share; other rooms use scan_odometry.h.
namespace slam::odometry {

std::unique_ptr<ScanOdometry> makeArgmaxOdometry(const ScanOdometryOptions& options);
std::unique_ptr<ScanOdometry> makeCorrelationOdometry(const ScanOdometryOptions& options);

/// ContractError unless the scan has at least 2 beams and a finite, positive step.
void requireUsable(const robot::Scan& scan);

/// The answer to the first scan of all: nothing moved, and that is certain.
ScanMotion noMotionYet();
/// Nothing could be measured: the identity, unreliable, with the search range as standard deviation.
ScanMotion unknownMotion(const ScanOdometryOptions& options);

}  // namespace slam::odometry
