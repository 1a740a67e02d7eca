#pragma once
#include <optional>
#include <vector>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/threads/paced_work.h"

namespace slam::keyframes {

/// Finds all poses of a map anew, and how sure they are: on a copy, so that the map may grow meanwhile, and
/// in pieces, as threads::PacedWork takes them. For the rooms of graph SLAM only.
class Settling {
 public:
  /// Of the map as it stands. `options`: how the poses are found. Errors: as posegraph::OptimizeInPieces.
  Settling(const KeyframeMap& map, const posegraph::OptimizeOptions& options);
  /// See threads::PacedWork::Step. Errors: as posegraph::Marginals.
  bool advance(double& work);
  /// REQUIRES that it is done.
  const Settled& result() const { return result_; }

 private:
  enum class Stage { kPoses, kWays, kCovariances, kTaken };
  Stage stage_ = Stage::kPoses;
  threads::PaidFirst dear_;
  std::optional<posegraph::OptimizeInPieces> poses_;
  Witnesses witnesses_;
  std::vector<Eigen::Matrix3d> noise_;  ///< of each keyframe
  Settled result_;
};

}  // namespace slam::keyframes
