// Aligns one scan with another, without a map, a log or a world: how far did the lidar move between them?
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "libslam/scanmatch/surfel_matcher.h"

namespace {

/// What a lidar sees at `pose` in an empty room of 6 m by 4 m about the origin; yours would come from a
/// driver.
slam::lidar::Scan scanAt(const slam::core::Pose2& pose) {
  slam::lidar::Scan scan;
  scan.first_angle_rad = -slam::core::kPi;
  scan.step_rad = slam::core::degToRad(1);
  scan.max_range_m = 20;
  scan.range_sigma_m = 0.01;
  for (int beam = 0; beam < 360; ++beam) {
    const double angle = pose.phi + scan.angle(static_cast<size_t>(beam));
    const double to_x = ((std::cos(angle) > 0 ? 3 : -3) - pose.x) / std::cos(angle);
    const double to_y = ((std::sin(angle) > 0 ? 2 : -2) - pose.y) / std::sin(angle);
    scan.ranges_m.push_back(static_cast<float>(std::min(to_x, to_y)));
  }
  return scan;
}

}  // namespace

int main() {
  using namespace slam::scanmatch;
  const slam::core::Pose2 truth{0.25, -0.10, slam::core::degToRad(6)};
  SurfelMap map(/*cell_m=*/0.2, /*blur_m=*/0.01);
  map.clear(/*centre=*/{}, /*reach_m=*/8);
  map.add(patchPoints(scanAt({}), {}), {});
  MatchOptions options;
  options.max_iterations = 50;
  const auto match =
      alignToSurfels(patchPoints(scanAt(truth), {}), map, /*T_start=*/{}, /*prior=*/{}, options);
  const Eigen::Matrix3d covariance = match.information.inverse();
  const auto& found = match.T_map_robot;
  std::printf("moved by x %.3f m, y %.3f m, %.2f degrees; sure to %.3f m, %.3f m, %.2f degrees\n", found.x,
              found.y, slam::core::radToDeg(found.phi), std::sqrt(covariance(0, 0)),
              std::sqrt(covariance(1, 1)), slam::core::radToDeg(std::sqrt(covariance(2, 2))));
  return slam::core::distance(found, truth) < 0.02 ? 0 : 1;
}
