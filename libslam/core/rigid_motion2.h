#pragma once
#include "libslam/core/elementary.h"
#include "libslam/core/pose2.h"

namespace slam::core {

/// The motion of a pose, its sine and cosine taken once: for many points, with the same bits as the pose's
/// own product with each.
class RigidMotion2 {
 public:
  explicit RigidMotion2(const Pose2& T_a_b) : RigidMotion2(T_a_b, sinCos(T_a_b.phi)) {}

  /// p_a = T_a_b * p_b.
  Point2 operator*(const Point2& p_b) const {
    return {x_ + cosine_ * p_b.x - sine_ * p_b.y, y_ + sine_ * p_b.x + cosine_ * p_b.y};
  }

 private:
  RigidMotion2(const Pose2& T_a_b, const SinCos& both)
      : x_(T_a_b.x), y_(T_a_b.y), cosine_(both.cosine), sine_(both.sine) {}

  double x_, y_, cosine_, sine_;
};

}  // namespace slam::core
