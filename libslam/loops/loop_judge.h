#pragma once
#include <functional>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/keyframes/types.h"

namespace slam::loops {

/// What speaks for a place that may have been recognised, and for others that are followed beside it: the way
/// from there to here, with its covariance, and the scans.
///
/// Sources: innovation gates as in Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking
/// and Navigation, 2001. Weighing places against each other by scans and by how a way may err is ours.
class LoopJudge {
 public:
  /// Of the keyframes' poses in the map, and how sure the way from the first to the second is: of the second
  /// one's x, y, phi in the first one's frame. All have to stay as they are meanwhile.
  using Way = std::function<Eigen::Matrix3d(int, int)>;
  LoopJudge(const std::vector<core::Pose2>& poses, const keyframes::Keyframes& keyframes, Way way)
      : poses_(poses), keyframes_(keyframes), way_(std::move(way)) {}

  /// How far a loop lies from where the way between has its keyframe: squared, in standard deviations of that
  /// way taken to err by four times what it claims, and of the scans. Of a loop that was asked before: what
  /// was said then.
  double innovation(const keyframes::Hypothesis& loop);
  /// What lies beyond the map can be anything. Where the robot comes to the map from outside, its place may
  /// be one of those that the map says little of as yet.
  enum class Beyond { kCounts, kIsNoRival };
  /// Whether no other place, or none that the map says enough of, is nearly as good.
  bool isBest(const keyframes::Hypothesis& loop, const std::vector<keyframes::Hypothesis>& others,
              Beyond beyond);

 private:
  const std::vector<core::Pose2>& poses_;
  const keyframes::Keyframes& keyframes_;
  Way way_;
};

/// Nats by which a loop is ahead of every other place that is followed: one wrong in a thousand.
inline constexpr double kAheadOfRival = 7;

}  // namespace slam::loops
