#include "libslam/bags/ros_scan.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace slam::bags {
namespace {

std::vector<float> firstEchoes(const std::vector<std::vector<float>>& echoes, float of_none) {
  std::vector<float> first;
  first.reserve(echoes.size());
  for (const auto& beam : echoes) first.push_back(beam.empty() ? of_none : beam.front());
  return first;
}

std::int32_t roundedIntensity(float value) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  if (std::isnan(value)) return 0;
  return static_cast<std::int32_t>(std::lround(std::clamp(static_cast<double>(value), -kMost, kMost)));
}

}  // namespace

ScanAngles anglesOf(const RosLaserScan& scan) {
  const double steps = static_cast<double>(scan.ranges.size() - 1);
  const double step_rad = scan.angle_increment;
  double span_rad = steps * step_rad;
  const double stated_rad = static_cast<double>(scan.angle_max) - static_cast<double>(scan.angle_min);
  if (std::abs(stated_rad - span_rad) <= 1e-3 * std::abs(step_rad)) span_rad = stated_rad;
  const double first_rad = scan.angle_min;
  if (span_rad < 0) return {first_rad + span_rad, -span_rad, true};
  return {first_rad, span_rad, false};
}

lidar::Sweep timesOf(const RosLaserScan& scan, bool reversed) {
  const double span_s = static_cast<double>(scan.ranges.size() - 1) * scan.time_increment;
  const bool runs_back = span_s < 0;
  return {std::abs(span_s), reversed != runs_back, runs_back ? 1.0 : 0.0};
}

RosLaserScan singleEcho(const RosMultiEchoLaserScan& multi) {
  RosLaserScan scan;
  scan.header = multi.header;
  scan.angle_min = multi.angle_min;
  scan.angle_max = multi.angle_max;
  scan.angle_increment = multi.angle_increment;
  scan.time_increment = multi.time_increment;
  scan.range_min = multi.range_min;
  scan.range_max = multi.range_max;
  // Nothing came back along a beam without echoes.
  scan.ranges = firstEchoes(multi.ranges, std::numeric_limits<float>::infinity());
  scan.intensities = firstEchoes(multi.intensities, 0);
  return scan;
}

void setReadings(const RosLaserScan& scan, bool reversed, mrpt::obs::CObservation2DRangeScan& observation) {
  const size_t beams = scan.ranges.size();
  observation.resizeScan(beams);
  const bool has_intensities = scan.intensities.size() == beams;
  observation.setScanHasIntensity(has_intensities);
  for (size_t i = 0; i < beams; ++i) {
    const size_t from = reversed ? beams - 1 - i : i;
    const float range_m = scan.ranges[from];
    const bool far = range_m >= observation.maxRange;
    const bool valid = !far && range_m > 0 && range_m >= scan.range_min;
    observation.setScanRange(i, valid ? range_m : far ? observation.maxRange : 0.0F);
    observation.setScanRangeValidity(i, valid);
    if (has_intensities) observation.setScanIntensity(i, roundedIntensity(scan.intensities[from]));
  }
}

}  // namespace slam::bags
