#include "libslam/core/pose2.h"

#include "libslam/core/elementary.h"

namespace slam::core {

double wrapToPi(double angle_rad) {
  if (angle_rad > -kPi && angle_rad <= kPi) return angle_rad;
  const double wrapped = std::remainder(angle_rad, 2 * kPi);  // in [-pi, pi]
  return wrapped <= -kPi ? kPi : wrapped;
}

Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c) {
  const auto [s, c] = core::sinCos(T_a_b.phi);
  return {T_a_b.x + c * T_b_c.x - s * T_b_c.y, T_a_b.y + s * T_b_c.x + c * T_b_c.y,
          wrapToPi(T_a_b.phi + T_b_c.phi)};
}

Point2 operator*(const Pose2& T_a_b, const Point2& p_b) {
  const auto [s, c] = core::sinCos(T_a_b.phi);
  return {T_a_b.x + c * p_b.x - s * p_b.y, T_a_b.y + s * p_b.x + c * p_b.y};
}

Pose2 inverse(const Pose2& T_a_b) {
  const auto [s, c] = core::sinCos(T_a_b.phi);
  return {-c * T_a_b.x - s * T_a_b.y, s * T_a_b.x - c * T_a_b.y, wrapToPi(-T_a_b.phi)};
}

Pose2 between(const Pose2& T_a_b, const Pose2& T_a_c) {
  const auto [s, c] = core::sinCos(T_a_b.phi);
  const double dx = T_a_c.x - T_a_b.x, dy = T_a_c.y - T_a_b.y;
  return {c * dx + s * dy, -s * dx + c * dy, wrapToPi(T_a_c.phi - T_a_b.phi)};
}

bool isFinite(const Pose2& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.phi);
}

Pose2 interpolate(const Pose2& a, const Pose2& b, double s) {
  return {a.x + s * (b.x - a.x), a.y + s * (b.y - a.y), wrapToPi(a.phi + s * angleDifference(b.phi, a.phi))};
}

double pathLength(const Trajectory& trajectory) {
  double length_m = 0;
  for (size_t i = 1; i < trajectory.size(); ++i)
    length_m += distance(trajectory[i - 1].pose, trajectory[i].pose);
  return length_m;
}

}  // namespace slam::core
