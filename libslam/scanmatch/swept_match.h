#pragma once
#include <Eigen/Core>
#include <vector>

#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::scanmatch {

/// A scan whose beams were measured one after the other over a step of the robot, deskewed by a step that
/// errs: to find the pose at its stamp, and what the step was beyond what the scan was deskewed by. A scan
/// alone tells both, for its early beams move with the pose before, its late ones with the new one.
struct SweptPrior {
  /// Of the pose at the stamp as the step alone has it: what the pose before errs by.
  PosePrior before;
  Eigen::Vector3d more = Eigen::Vector3d::Zero();  ///< of the step, as SweptMatch::more; and how sure it is:
  Eigen::Matrix3d step_information;                ///< over the step's x, y (m) and phi (rad), map axes
};
struct SweptMatch {
  core::Pose2 T_map_robot;                                    ///< at the stamp
  Eigen::Vector3d more = Eigen::Vector3d::Zero();             ///< of the step; x, y (m), phi (rad), map axes
  Eigen::Matrix3d more_covariance = Eigen::Matrix3d::Zero();  ///< of that, as the options weigh the points
  double score = 0;                                           ///< as MatchResult::score
  /// What the pose errs by: times the points' variance, by them as if they were independent; by what the pose
  /// before errs by, and by what the step does.
  Eigen::Matrix3d by_points = Eigen::Matrix3d::Zero(), by_before = Eigen::Matrix3d::Zero(),
                  by_step = Eigen::Matrix3d::Zero();
};

/// Of the points of a scan that was deskewed (by what: Scan::deskewing), how much of the step before the
/// stamp each was measured, 0 at the stamp, 1 when the step began: a beam is known by its bearing.
std::vector<float> agoOf(const std::vector<PatchPoint>& points, const lidar::Scan& scan);

/// Gauss-Newton from pose and step of `start`. `ago`: agoOf(). The step's prior is robust as the options'
/// prior kernel says. REQUIRES as many as points.
SweptMatch alignSweptToSurfels(const std::vector<PatchPoint>& points, const std::vector<float>& ago,
                               const SurfelMap& map, const SweptMatch& start, const SweptPrior& prior,
                               const MatchOptions& options);

/// The points as they are when the step was more than they were deskewed by; `phi_rad`: the robot's heading.
std::vector<PatchPoint> sweptBy(const std::vector<PatchPoint>& points, const std::vector<float>& ago,
                                const Eigen::Vector3d& more, double phi_rad);

}  // namespace slam::scanmatch
