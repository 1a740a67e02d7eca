#pragma once
#include <memory>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"

namespace mrpt::obs {
class CObservation2DRangeScan;
class CSensoryFrame;
}  // namespace mrpt::obs
namespace mrpt::math {
struct TPose2D;
}

namespace slam::lidar {

/// The same sweep as MRPT's observation: rightToLeft, aperture = (n - 1) * step (MRPT's own meaning: first to
/// last beam), centred by turning the sensor pose when first + last angle is not zero (MRPT has no first
/// angle), no-return = maxRange and invalid, lost = 0 and invalid. The label is "LASER". REQUIRES at least 2
/// beams (ContractError).
std::shared_ptr<mrpt::obs::CObservation2DRangeScan> toMrpt(const Scan& scan);

/// Puts toMrpt(scan) into a frame with another stamp (seconds since the Unix epoch). Lidars of one frame are
/// told apart by their labels: "LASER", "LASER 2" and so on; MRPT's ICP counts the way since the last
/// insertion by them.
void addTo(mrpt::obs::CSensoryFrame& frame, const Scan& scan, double time_s);

/// And back. A scan that goes left to right is turned round. Invalid readings at or beyond 0.99 of maxRange
/// become kNoReturn, other invalid ones kLostReading; valid readings <= 0 or not finite become kLostReading,
/// valid readings >= maxRange kNoReturn. Errors: fewer than 2 beams, aperture not in (0, 2 pi], or a sensor
/// pose that is not finite (InputError, without a file name: the caller adds it).
Scan fromMrpt(const mrpt::obs::CObservation2DRangeScan& observation);

/// Whether its beams turn to the left. MRPT takes the byte that a file has for a bool, and a damaged file has
/// any.
bool isRightToLeft(const mrpt::obs::CObservation2DRangeScan& observation);

mrpt::math::TPose2D toMrpt(const core::Pose2& pose);
core::Pose2 fromMrpt(const mrpt::math::TPose2D& pose);

}  // namespace slam::lidar
