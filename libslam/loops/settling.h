#pragma once
#include <memory>
#include <optional>

#include "libslam/keyframes/keyframe_map.h"
#include "libslam/posegraph/optimize.h"
#include "libslam/threads/paced_work.h"
#include "libslam/uncertainty/error_flow.h"

namespace slam::loops {

/// Finds all poses of a map anew, and draws what they err by: on a copy, so that the map may grow meanwhile,
/// and in pieces, as threads::PacedWork takes them. For the rooms of graph SLAM only.
class Settling {
 public:
  enum class What { kPoses, kErrorsToo };
  /// Of the map as it stands. `options`: how the poses are found. Errors: as posegraph::OptimizeInPieces.
  Settling(const keyframes::KeyframeMap& map, const posegraph::OptimizeOptions& options, What what);
  /// See threads::PacedWork::Step. Errors: as uncertainty::ErrorFlow.
  bool advance(double& work);
  /// REQUIRES that it is done.
  const keyframes::Settled& result() const { return result_; }

 private:
  enum class Stage { kPoses, kErrors, kDraws, kTaken };
  bool draw(double& work);
  Stage stage_ = Stage::kPoses;
  threads::PaidFirst dear_;
  std::optional<posegraph::OptimizeInPieces> poses_;
  std::optional<uncertainty::ErrorSources> sources_;
  std::unique_ptr<const uncertainty::ErrorFlow> flow_;
  int drawn_ = 0;  ///< pieces
  keyframes::Settled result_;
};

}  // namespace slam::loops
