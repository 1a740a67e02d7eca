#pragma once
#include <vector>

#include "libslam/graph/types.h"
#include "libslam/posegraph/marginals.h"

namespace slam::graph {

/// What speaks for a place that may have been recognised, and for others that are followed beside it: the way
/// from there to here, with its covariance, and the scans. A snapshot of the graph.
///
/// Sources: innovation gates as in Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking
/// and Navigation, 2001. Weighing places against each other, scan by scan, is ours.
class LoopJudge {
 public:
  /// `witnesses` has the keyframes' poses and what is known of them from one another. Cost: one
  /// factorisation.
  LoopJudge(const posegraph::PoseGraph& witnesses, const std::vector<Keyframe>& keyframes)
      : T_map_keyframes_(witnesses.poses()),
        path_(witnesses, posegraph::Marginals::Open::kBounded),
        keyframes_(keyframes) {}

  /// How far a loop lies from where the way between has its keyframe: squared, in standard deviations of that
  /// way and of the scans. Of chi-square's distribution with three degrees when it is right.
  double innovation(const Hypothesis& loop) const;
  /// Whether no other place that the map says enough of is nearly as good.
  bool isBest(const Hypothesis& loop, const std::vector<Hypothesis>& others) const;

 private:
  std::vector<core::Pose2> T_map_keyframes_;
  posegraph::Marginals path_;
  const std::vector<Keyframe>& keyframes_;
};

}  // namespace slam::graph
