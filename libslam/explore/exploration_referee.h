#pragma once
#include <optional>

#include "libslam/explore/explore.h"
#include "libslam/world/plan.h"

namespace slam::explore {

/// Ends what leads nowhere, by the truth.
class Referee {
 public:
  explicit Referee(const ExplorationOptions& options) : options_(options) {}
  /// `waits`: the strategy has said that it waits for somebody, and does not count as stuck meanwhile.
  std::optional<ExplorationEnd> judge(double time_s, double explored_m2, const core::Pose2& T_world_robot,
                                      bool waits = false);
  /// From now on new area is not asked for.
  void watchReturn() { returning_ = true; }

 private:
  ExplorationOptions options_;
  bool returning_ = false;
  std::optional<core::Pose2> place_;
  double placed_at_s_ = 0, explored_at_s_ = 0, explored_m2_ = 0;
  double judged_at_s_ = 0, waited_s_ = 0;  ///< since there was anything new
};

/// Counts episodes of coming too near to a wall.
class NearMisses {
 public:
  NearMisses(const world::Plan& plan, double radius_m) : plan_(plan), radius_m_(radius_m) {}
  void look(const core::Pose2& T_world_robot);
  double count() const { return count_; }

 private:
  const world::Plan& plan_;
  double radius_m_, count_ = 0;
  bool near_ = false;
};

}  // namespace slam::explore
