#pragma once
#include "libslam/core/pose2.h"

namespace slam::wheels {

/// Whether the wheels tell forwards from backwards: some count every metre forwards. Learnt while the robot
/// drives, by the metres that are counted backwards and were so as a map shows, and by those that went the
/// other way than they were counted. Metres forwards say little of it.
class WaySign {
 public:
  /// A step of the wheels, and as it was matched; both m, rad, in the robot's frame before it. `told`: of
  /// what holds the match along the way, the scan's share, in [0, 1]. Nothing is learnt of one that says too
  /// little, stands, or is not finite.
  void learn(const core::Pose2& T_wheels, const core::Pose2& T_matched, double told);
  /// What speaks against a step that went the other way than it was counted, in nats.
  double against() const;

 private:
  double signed_m_ = 0, reversed_m_ = 0;
};

}  // namespace slam::wheels
