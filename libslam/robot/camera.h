#pragma once
#include <string>
#include <vector>

#include "libslam/core/random.h"
#include "libslam/files/parameters.h"
#include "libslam/lidar/lidar.h"

namespace slam::robot {

/// Where the camera sits and how wide it sees; section [camera]. In the original document's letters: x_m is
/// YC, -y_m is XC, height_m is ZC. It looks along the robot's heading.
struct CameraOptions {
  double x_m, y_m;              ///< of the optical centre, in the robot frame
  double height_m;              ///< of the optical centre above the floor
  double pitch_rad;             ///< of the optical axis below the horizontal
  double fov_x_rad, fov_y_rad;  ///< whole view angles of the picture, left to right and top to bottom
  std::string area;             ///< exact | original

  CameraOptions();
  static const files::ParameterTable<CameraOptions>& table();
};

/// The floor that a pinhole camera sees. With X the distance ahead of the camera's foot, Y the distance to
/// the left of it, H the height, p the pitch, a and b half the view angles (x and y), a floor point has the
/// depth D = X cos p + H sin p along the optical axis, lies V = H cos p - X sin p below the axis and Y beside
/// it, and is in the picture when |V| < D tan b and |Y| < D tan a. Solved for X:
///
///   nearest   Ymin = H / tan(p + b)      nothing is visible unless p + b > 0
///   farthest  Ymax = H / tan(p - b)      infinite when p <= b: the horizon is in the picture
///   half width at X:  Xm = (X cos p + H sin p) tan a
///
/// The original document has the same Ymin, no Ymax, and Xm = X tan a ("original"). The two widths are equal
/// for a level camera; otherwise the exact one is wider nearer than H / tan(p / 2), where they cross, and
/// narrower beyond, by cos p far away. So the original remembers ghosts near the camera that are gone, and
/// forgets obstacles far ahead at the sides that the camera cannot see.
struct VisibleFloor {
  double x_m, y_m;                                ///< the camera's foot, robot frame
  double nearest_m, farthest_m;                   ///< Ymin and Ymax as x in the robot frame; +infinity: none
  double half_width_at_foot_m, half_width_slope;  ///< of Xm
  /// Xm at a place ahead, x in the robot frame; negative where nothing is visible.
  double halfWidth_m(double at_x_m) const { return half_width_at_foot_m + half_width_slope * (at_x_m - x_m); }
};
VisibleFloor visibleFloor(const CameraOptions& options);

/// How the floor that the camera sees becomes a scan; section [camera_scan]. The original document has
/// nothing of it: all of this is ours.
struct CameraScanOptions {
  int beams_per_circle;   ///< bearings are multiples of a circle by this
  double reach_m;         ///< from the camera's foot; farther floor is not judged
  double rate_hz;         ///< pictures per second
  double edge_sigma_rad;  ///< noise of the angle under which an obstacle's foot is seen
  double drop_out;        ///< probability that nothing is found under a bearing

  CameraScanOptions();
  static const files::ParameterTable<CameraScanOptions>& table();
};

/// A camera that looks at the floor.
struct FloorCamera {
  CameraOptions view;
  CameraScanOptions scan;
};

/// InputError naming section and key for a camera that sees no floor: its picture ends above the horizon, or
/// the floor begins (Ymin) beyond the reach or behind the far edge; and for bearings too coarse to look
/// anywhere but straight ahead.
void requireSensible(const FloorCamera& camera);

/// Where along one bearing the floor is visible, from the camera's foot; nothing where begin_m >= end_m.
struct BearingSpan {
  double begin_m, end_m;
};
BearingSpan bearingSpan(const FloorCamera& camera, double bearing_rad);

/// The scan that the camera gives, as the lidar that would give it: beams symmetrical about straight ahead,
/// as far aside as any floor is visible; from the camera's foot; ranges from Ymin to the reach or the far
/// edge, whichever is nearer; noise as in edgeSigma() at 3 m. REQUIRES requireSensible().
lidar::LidarOptions asLidar(const FloorCamera& camera);

/// Half of the angle of the wedge, in radians, along whose bearings all floor is visible from the near edge
/// to asLidar()'s maximum range. Farther aside the sides of the picture end it sooner.
double wholeHalfAngle(const FloorCamera& camera);

/// Standard deviation of an obstacle's distance when the angle under which its foot is seen is off by
/// edge_sigma_deg: (r^2 + H^2) / H times that. It grows with the square of the distance.
double edgeSigma(const FloorCamera& camera, double range_m);

/// What the camera makes of exact distances to the nearest obstacle along asLidar()'s beams (infinity =
/// none): a reading where the obstacle's foot is in the picture, kNoReturn where floor is all that is seen up
/// to the maximum range, kLostReading where nothing is known: the obstacle stands in the dead zone and hides
/// the floor, or the picture's side ends the visible floor before an obstacle or the maximum range. Two draws
/// a beam whatever happens.
void applyCameraErrors(const FloorCamera& camera, core::RandomStream& random, std::vector<float>& ranges_m);

}  // namespace slam::robot
