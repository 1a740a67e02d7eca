#pragma once
#include "libslam/choices/tour_stops.h"
#include "libslam/strategies/map_strategy.h"

namespace slam::strategies {

/// An open tour over all views that are left, planned anew whenever the map has grown (after Kulich, Faigl
/// and Preucil, "On distance utility in the exploration task", ICRA 2011): few viewpoints that together show
/// what all of them do, ordered by 2-opt and Or-opt on the lengths of the ways between them; the first is
/// driven to.
///
/// What is ours:
/// - Walls go on (see paths::closeWalls()), and a frontier narrower than a door leads into no room (see
///   Openings): the expected gain of the slivers that every drive leaves is small.
/// - A stop that is expected to show much is urgent: a metre driven before it costs kUrgency times its share
///   of all that is expected besides the metre itself.
/// - The turn to a stop counts as the way that could be driven in its time.
/// - The stop aimed at stays the first one unless another tour is shorter by kHysteresis_m.
/// - A tour that is expected to show less than kWorthTheWay_m2pm for its length is not driven: what it is for
///   counts as given up.
class Tour : public MapStrategy {
 public:
  Tour(const StrategyOptions& options, core::RandomStream) : MapStrategy(options) {}
  /// Also no longer once the map has grown by kNews_m2: the tour may then be another one.
  bool isStillGood(const choices::Decision& decision, const core::Pose2& T_map_robot,
                   std::size_t next_waypoint) override;

 private:
  std::optional<Choice> choose(const Prospects& prospects) override;
  double closedGap_m() const override { return options().frontier_min_m; }
  std::optional<std::size_t> sharedViewpoints() const override;
  bool wantsStandoffs() const override { return false; }

  choices::Openings openingsOf(const Prospects& prospects) const;

  std::optional<core::Point2> aim_;  ///< the stop of the last decision
  std::size_t known_cells_ = 0;      ///< of the map at the last decision
};

}  // namespace slam::strategies
