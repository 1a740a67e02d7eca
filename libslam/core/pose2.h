#pragma once
#include <cmath>
#include <vector>

#include "libslam/core/elementary.h"

namespace slam::core {

inline constexpr double kPi = 3.14159265358979323846;

constexpr double degToRad(double degrees) {
  return degrees * (kPi / 180.0);
}
constexpr double radToDeg(double radians) {
  return radians * (180.0 / kPi);
}

/// The same angle in (-pi, pi]. NaN and infinity give NaN.
double wrapToPi(double angle_rad);

/// a - b along the shorter way round, in (-pi, pi].
inline double angleDifference(double a_rad, double b_rad) {
  return wrapToPi(a_rad - b_rad);
}

struct Point2 {
  double x = 0;  ///< metres
  double y = 0;  ///< metres
};

/// The point at a distance (metres) in a direction (radians) from the origin.
inline Point2 polar(double distance_m, double angle_rad) {
  const auto [sine, cosine] = core::sinCos(angle_rad);
  return {distance_m * cosine, distance_m * sine};
}

/// A rigid motion of the plane, SE(2): rotate by phi, then shift by (x, y).
/// As T_a_b it is the pose of frame b in frame a and takes coordinates in b to coordinates in a.
/// Metres and radians, x ahead, y left, counter-clockwise positive. phi is kept as given; compositions wrap
/// it.
struct Pose2 {
  double x = 0;
  double y = 0;
  double phi = 0;
};
/// The same numbers: headings a turn apart are not.
inline bool operator==(const Pose2& a, const Pose2& b) {
  return a.x == b.x && a.y == b.y && a.phi == b.phi;
}

/// T_a_c = T_a_b * T_b_c.
Pose2 operator*(const Pose2& T_a_b, const Pose2& T_b_c);
/// p_a = T_a_b * p_b.
Point2 operator*(const Pose2& T_a_b, const Point2& p_b);
/// T_b_a.
Pose2 inverse(const Pose2& T_a_b);
/// T_a_b^-1 * T_a_c: where c is, seen from b.
Pose2 between(const Pose2& T_a_b, const Pose2& T_a_c);

/// Distance of the two origins in metres.
inline double distance(const Pose2& a, const Pose2& b) {
  return core::hypot(a.x - b.x, a.y - b.y);
}
inline double distance(const Point2& a, const Point2& b) {
  return core::hypot(a.x - b.x, a.y - b.y);
}
/// distance(a, b) < limit_m, mostly without a root: where one coordinate alone is that far off it is not.
inline bool areWithin(const Point2& a, const Point2& b, double limit_m) {
  return std::abs(a.x - b.x) < limit_m && std::abs(a.y - b.y) < limit_m && distance(a, b) < limit_m;
}
inline Point2 position(const Pose2& pose) {
  return {pose.x, pose.y};
}
bool isFinite(const Pose2& pose);

/// Between a (s = 0) and b (s = 1): the position on the straight line, the heading along the shorter way
/// round.
Pose2 interpolate(const Pose2& a, const Pose2& b, double s);

struct StampedPose {
  double time_s = 0;  ///< seconds since the Unix epoch, as in the log
  Pose2 pose;
};

/// Poses in the order of their stamps, which never run back (writers and readers in room logs keep it so).
using Trajectory = std::vector<StampedPose>;

/// Length of the polyline through the positions, metres.
double pathLength(const Trajectory& trajectory);

/// What somebody knows of the motion between two moments: the robot's pose at to_time_s seen from that at
/// from_time_s. Two such moments may be in any order, and far apart: a place seen again.
struct Relation {
  double from_time_s = 0, to_time_s = 0;  ///< seconds, as the log's stamps
  Pose2 T_from_to;
};
using Relations = std::vector<Relation>;

}  // namespace slam::core
