#pragma once
#include <memory>

#include "libslam/odometry/scan_odometry.h"

namespace mrpt::obs {
class CActionCollection;
}

namespace slam::odometry {

/// One step of scan odometry as stock programs of MRPT take it from a rawlog: a collection of two actions of
/// the same mean and stamp. First a CActionRobotMovement2D of kind emOdometry whose Gaussian motion model has
/// about the motion's spread: the file holds the model, and rbpf-slam, which takes the first action, spreads
/// its particles by it. Then that of toMrptAction(), kind emScan2DMatching, with the full covariance: what
/// getBestMovementEstimation() gives (icp-slam, graphslam-engine), and whose model the file does not hold. No
/// program counts both. time_s is seconds since the Unix epoch. Errors: a motion or time that is not finite
/// (ContractError).
std::shared_ptr<mrpt::obs::CActionCollection> toMrptActions(const ScanMotion& motion, double time_s);

}  // namespace slam::odometry
