#include "libslam/lidar/mrpt_types.h"

#include <mrpt/core/Clock.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3D.h>

#include <algorithm>
#include <cstring>
#include <string>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::lidar {

mrpt::math::TPose2D toMrpt(const core::Pose2& pose) {
  return {pose.x, pose.y, pose.phi};
}
core::Pose2 fromMrpt(const mrpt::math::TPose2D& pose) {
  return {pose.x, pose.y, pose.phi};
}

std::shared_ptr<mrpt::obs::CObservation2DRangeScan> toMrpt(const Scan& scan) {
  const size_t beams = scan.ranges_m.size();
  if (beams < 2) throw core::ContractError("toMrpt: a scan needs at least 2 beams");
  auto observation = mrpt::obs::CObservation2DRangeScan::Create();
  observation->timestamp = mrpt::Clock::fromDouble(scan.time_s);
  observation->sensorLabel = "LASER";
  observation->rightToLeft = true;
  const double aperture_rad = static_cast<double>(beams - 1) * scan.step_rad;
  observation->aperture = static_cast<float>(aperture_rad);
  observation->maxRange = static_cast<float>(scan.max_range_m);
  observation->stdError = static_cast<float>(scan.range_sigma_m);
  // MRPT's beams are centred on the sensor's x axis; a sweep that is not is the same sweep of a turned
  // sensor.
  const double centre_rad = scan.first_angle_rad + aperture_rad / 2;
  const auto& mount = scan.T_robot_lidar;
  observation->sensorPose =
      mrpt::poses::CPose3D(mount.x, mount.y, 0, core::wrapToPi(mount.phi + centre_rad), 0, 0);
  observation->resizeScan(beams);
  for (size_t i = 0; i < beams; ++i) {
    const float range_m = scan.ranges_m[i];
    const bool valid = isReturn(range_m);
    const float invalid_value = std::isnan(range_m) ? 0.0F : observation->maxRange;
    observation->setScanRange(i, valid ? range_m : invalid_value);
    observation->setScanRangeValidity(i, valid);
  }
  return observation;
}

bool isRightToLeft(const mrpt::obs::CObservation2DRangeScan& observation) {
  unsigned char byte = 0;
  std::memcpy(&byte, &observation.rightToLeft, 1);
  return byte != 0;
}

void addTo(mrpt::obs::CSensoryFrame& frame, const Scan& scan, double time_s) {
  const auto observation = toMrpt(scan);
  observation->timestamp = mrpt::Clock::fromDouble(time_s);
  if (!frame.empty()) observation->sensorLabel += " " + std::to_string(frame.size() + 1);
  frame.insert(observation);
}

Scan fromMrpt(const mrpt::obs::CObservation2DRangeScan& observation) {
  const size_t beams = observation.getScanSize();
  if (beams < 2)
    throw core::InputError("laser scan with " + std::to_string(beams) + " beams, expected at least 2");
  const double aperture_rad = observation.aperture;
  if (!(aperture_rad > 0 && aperture_rad <= 2 * core::kPi + 1e-4))
    throw core::InputError("laser scan with a field of view of " +
                           files::formatNumber(core::radToDeg(aperture_rad)) +
                           " deg, expected above 0 and at most 360");
  Scan scan;
  scan.time_s = mrpt::Clock::toDouble(observation.timestamp);
  scan.step_rad = aperture_rad / static_cast<double>(beams - 1);
  scan.first_angle_rad = -aperture_rad / 2;
  scan.max_range_m = observation.maxRange;
  scan.range_sigma_m = observation.stdError;
  const auto& mount = observation.sensorPose;
  scan.T_robot_lidar = {mount.x(), mount.y(), mount.yaw()};
  if (!core::isFinite(scan.T_robot_lidar))
    throw core::InputError("laser scan with a mounting pose that is not finite");
  if (!(scan.max_range_m > 0))
    throw core::InputError("laser scan with maximum range " + files::formatNumber(scan.max_range_m) +
                           ", expected above 0");
  scan.ranges_m.resize(beams);
  for (size_t i = 0; i < beams; ++i) {
    const float range_m = observation.getScanRange(i);
    const bool far = std::isfinite(range_m) && range_m >= 0.99F * observation.maxRange;
    float reading = kLostReading;
    if (observation.getScanRangeValidity(i) && isReturn(range_m))
      reading = range_m >= observation.maxRange ? kNoReturn : range_m;
    else if (far)
      reading = kNoReturn;
    scan.ranges_m[i] = reading;
  }
  if (!isRightToLeft(observation)) std::reverse(scan.ranges_m.begin(), scan.ranges_m.end());
  return scan;
}

}  // namespace slam::lidar
