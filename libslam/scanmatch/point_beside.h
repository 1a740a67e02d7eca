#pragma once
// For the .cpp files of this room only.
#include <algorithm>

#include "libslam/core/elementary.h"
#include "libslam/scanmatch/scan_points.h"
#include "libslam/scanmatch/surfel_map.h"

namespace slam::scanmatch {

/// What a sum of weights is divided by: the points within the window, and no fewer than this share of all.
inline constexpr double kLeastInside = 0.25;
inline double countedPoints(size_t points, int outside) {
  const auto all = static_cast<double>(points);
  return std::max(all - outside, kLeastInside * all);
}

/// A point's place beside the surfel that it falls on.
struct Beside {
  const Surfel* surfel;  ///< nullptr: none
  double share;          ///< of its information, see SurfelMap::facing()
  double rx, ry;         ///< the point from the robot, map axes
  double nx, ny;         ///< its normal, towards the lidar, of any length
  double dx, dy;         ///< from the surfel's mean
  double ax, ay;         ///< that share of the surfel's information times that
  double q, w;           ///< squared distance in standard deviations; robust weight
};

/// Points of a scan with the robot at a pose.
class AtPose {
 public:
  AtPose(const SurfelMap& map, const core::Pose2& T, double kernel)
      : map_(map),
        turn_(core::sinCos(T.phi)),
        tx_(T.x - map.origin().x),
        ty_(T.y - map.origin().y),
        inverse_kernel2_(1 / (kernel * kernel)) {}

  Beside beside(const PatchPoint& point) const {
    const auto [s, c] = turn_;
    Beside b{};
    b.rx = c * point.x - s * point.y, b.ry = s * point.x + c * point.y;
    b.nx = -(s * point.along_x + c * point.along_y), b.ny = c * point.along_x - s * point.along_y;
    const auto facing = map_.facing(tx_ + b.rx, ty_ + b.ry, b.nx, b.ny);
    b.surfel = facing.surfel, b.share = facing.share;
    if (!b.surfel) return b;
    b.dx = tx_ + b.rx - b.surfel->x, b.dy = ty_ + b.ry - b.surfel->y;
    b.ax = b.share * (b.surfel->xx * b.dx + b.surfel->xy * b.dy);
    b.ay = b.share * (b.surfel->xy * b.dx + b.surfel->yy * b.dy);
    b.q = b.dx * b.ax + b.dy * b.ay;
    const double root = 1 / (1 + b.q * inverse_kernel2_);
    b.w = root * root;
    return b;
  }
  bool isOutside(const Beside& b) const { return !map_.covers(tx_ + b.rx, ty_ + b.ry); }

 private:
  const SurfelMap& map_;
  core::SinCos turn_;
  double tx_, ty_, inverse_kernel2_;
};

}  // namespace slam::scanmatch
