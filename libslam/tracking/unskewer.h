#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/keyframe_map.h"
#include "libslam/lidar/scan.h"
#include "libslam/scanmatch/swept_match.h"
#include "libslam/tracking/motion.h"

namespace slam::tracking {

/// What is left of scans that were deskewed: odometry errs, so that they are skewed still, and matched askew.
/// Pose at the stamp and the step before are found together: early beams move with the pose before, late ones
/// with the new one. How far odometry's steps scatter is learnt from what is found of them. For the rooms of
/// SLAM methods only.
class Unskewer {
 public:
  using Points = std::vector<scanmatch::PatchPoint>;
  /// `map` has to stay where it is.
  explicit Unskewer(const keyframes::KeyframeMap& map) : map_(&map) {}

  struct Unskewed {
    scanmatch::SweptMatch match;
    Eigen::Matrix3d noise;  ///< covariance of its pose against the map as it is; map frame, m and rad
    Points points;          ///< as if all had been measured at the stamp; robot frame
    lidar::Scan scan;       ///< the same
  };
  /// From a match to maps of the keyframes around that takes the scan as it is. `told`: the step as odometry
  /// has it, which need not be what the scan was deskewed by. Nothing where the scan is no better explained.
  /// REQUIRES a scan that was deskewed, and points.
  std::optional<Unskewed> unskew(const lidar::Scan& scan, const Points& points,
                                 const keyframes::LevelMaps& maps, const core::Pose2& T_map_before,
                                 const Prediction& told, const scanmatch::MatchResult& matched);
  /// A scan was not asked about, or nothing came of it: how sure its pose is is not known.
  void forget() { covariance_.reset(); }

 private:
  void learnScatter(const scanmatch::SweptMatch& match, const Eigen::Vector3d& told, const Prediction& step);

  const keyframes::KeyframeMap* map_;
  double scatter_xy_ = 1, scatter_turn_ = 1;   ///< of odometry's steps, over what is expected of any robot's
  std::optional<Eigen::Matrix3d> covariance_;  ///< of the scan before, against the map as it is now
};

}  // namespace slam::tracking
