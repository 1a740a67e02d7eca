// Exit code 0 when all holds. ctest --test-dir build
#include <cmath>
#include <cstdio>

#include "@name@.h"

namespace {

/// What a lidar sees in a room of 6 x 4 m, in the middle but for x ahead.
slam::lidar::Scan scanAt(double time_s, double x) {
  slam::lidar::Scan scan;
  scan.time_s = time_s;
  scan.first_angle_rad = -slam::core::kPi;
  scan.step_rad = slam::core::kPi / 180;
  scan.max_range_m = 20;
  for (int i = 0; i < 360; ++i) {
    const double angle = scan.first_angle_rad + i * scan.step_rad, c = std::cos(angle), s = std::sin(angle);
    const double to_wall = c > 0 ? (3 - x) / c : c < 0 ? (-3 - x) / c : 1e9;
    const double to_side = s > 0 ? 2 / s : s < 0 ? -2 / s : 1e9;
    scan.ranges_m.push_back(static_cast<float>(std::fmin(to_wall, to_side)));
  }
  return scan;
}

int failures = 0;
void expect(bool holds, const char* what) {
  if (!holds) std::printf("failed: %s\n", what), ++failures;
}

}  // namespace

int main() {
  @Name@ method;
  slam::core::Pose2 pose;
  for (int i = 0; i <= 10; ++i) pose = method.update(scanAt(0.1 * i, 0.05 * i), {i == 0 ? 0 : 0.05, 0, 0});
  expect(std::abs(pose.x - 0.5) < 0.05 && std::abs(pose.y) < 0.05, "half a metre ahead is half a metre ahead");
  return failures;
}
