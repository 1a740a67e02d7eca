#pragma once
#include <Eigen/Core>
#include <vector>

#include "libslam/core/symmetric3.h"

namespace slam::keyframes {

/// Where a keyframe's error comes from. It was matched to surfaces that earlier keyframes saw first, and
/// takes over what those err by, in the share that each held the match; the rest is of the pose before; and
/// something is new. Map frame, x, y (m), phi (rad).
struct Inheritance {
  struct View {
    int keyframe;                  ///< that saw the surfaces first
    core::Symmetric3 information;  ///< of the match by them, as if points were independent
  };
  /// Those that told most, kMostViews at most: what is left out counts as not known. With two, three, four
  /// and eight of them the final poses of 20 drives have a median ANEES of 0.47, 0.63, 0.75 and 1.0, of 12 by
  /// spinning lidars 0.79, 0.98, 1.1 and 1.3.
  std::vector<View> views;
  /// Times a view's information: the share of its error that is taken over.
  Eigen::Matrix3d gain = Eigen::Matrix3d::Zero();
  int before = -1;       ///< keyframe that had the pose before; -1: the one that odometry's edge is from
  core::Symmetric3 own;  ///< covariance of what is new; zero: all that is known is odometry's edge
  /// What it sees itself errs by so many standard deviations of a point's noise: of a spinning lidar by more
  /// than one, since how the robot moved in its sweep is not known exactly.
  double points_err = 1;
  static constexpr int kMostViews = 3;
};

}  // namespace slam::keyframes
