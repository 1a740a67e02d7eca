#pragma once
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::navigate {

/// What was hit and is in no scan: the body above two legs, or what lies below the lidar's plane. As it may
/// be somebody, it is remembered for 10 s.
class Bumps {
 public:
  /// `p_map`: of the disc around the robot, foremost on the side to which it drove.
  void feel(const core::Point2& p_map);
  void pass(double duration_s);
  /// Map frame.
  const std::vector<core::Point2>& places() const { return places_; }

 private:
  std::vector<core::Point2> places_;
  std::vector<double> left_s_;  ///< of each
};

}  // namespace slam::navigate
