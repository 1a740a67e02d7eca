#pragma once
#include <Eigen/Core>

#include "libslam/core/pose2.h"

namespace slam::scanmatch {

/// What is known of a pose before a match: a Gaussian about `mean`, over x, y (m) and phi (rad) in the map
/// frame. Zero information: nothing.
struct PosePrior {
  core::Pose2 mean;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
};

}  // namespace slam::scanmatch
