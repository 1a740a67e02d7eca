#pragma once
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "libslam/keyframes/types.h"
#include "libslam/posegraph/marginals.h"

namespace slam::loops {

/// What speaks for a place that may have been recognised, and for others that are followed beside it: the way
/// from there to here, with its covariance, and the scans.
///
/// Sources: innovation gates as in Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking
/// and Navigation, 2001. Weighing places against each other, scan by scan, is ours.
class LoopJudge {
 public:
  /// `witnesses` gives the keyframes' poses and what is known of them from one another; it is asked once,
  /// when the first question comes. The keyframes have to stay as they are meanwhile.
  LoopJudge(std::function<posegraph::PoseGraph()> witnesses,
            const std::vector<keyframes::Keyframe>& keyframes)
      : witnesses_(std::move(witnesses)), keyframes_(keyframes) {}

  /// How far a loop lies from where the way between has its keyframe: squared, in standard deviations of that
  /// way and of the scans. Of chi-square's distribution with three degrees of freedom when it is right. The
  /// first one costs a factorisation, but for a loop that was asked before.
  double innovation(const keyframes::Hypothesis& loop);
  /// What lies beyond the map can be anything. Where the robot comes to the map from outside, its place may
  /// be one of those that the map says little of as yet.
  enum class Beyond { kCounts, kIsNoRival };
  /// Whether no other place, or none that the map says enough of, is nearly as good.
  bool isBest(const keyframes::Hypothesis& loop, const std::vector<keyframes::Hypothesis>& others,
              Beyond beyond);

 private:
  std::function<posegraph::PoseGraph()> witnesses_;
  std::vector<core::Pose2> poses_;
  std::optional<posegraph::Marginals> way_;
  const std::vector<keyframes::Keyframe>& keyframes_;
};

}  // namespace slam::loops
