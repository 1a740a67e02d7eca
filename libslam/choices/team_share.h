#pragma once
#include <vector>

#include "libslam/choices/decision.h"
#include "libslam/choices/viewpoint.h"
#include "libslam/paths/expected_gain.h"
#include "libslam/paths/free_space.h"
#include "libslam/paths/path_planner.h"

namespace slam::choices {

/// What the others are about to look at is no longer to be looked at: every unknown cell that a look round
/// from the goal of another robot is expected to show, up to kTaken_m from there, becomes an obstacle. So
/// frontiers there end and views of it gain nothing, whatever the strategy: the utilities reduced by what
/// others aim at of Burgard, Moors, Stachniss and Schneider (IEEE T-RO 21(3), 2005), all or nothing.
/// `looking` is only for looking; ways are planned on another one.
void closeTaken(paths::FreeSpace& looking, const std::vector<Teammate>& team, double unknown_path_m);
inline constexpr double kTaken_m = 5.0;

/// Whether another robot that is heard is on its way to look at something.
bool isAnyOnItsWay(const std::vector<Teammate>& team);

/// Leaves of the viewpoints those to which the fewest of the others are nearer by the way there: each robot
/// has its rank at every frontier and goes where it is best placed, which spreads them (MinPos: Bautin,
/// Simonin and Charpillet, "MinPos: a novel frontier allocation algorithm for multi-robot exploration",
/// ICIRA 2012). `theirs` are plans on the space of the viewpoints' nodes, one for each of `who`; of two as
/// near the one that goes first is nearer.
void keepWellPlaced(std::vector<Viewpoint>& viewpoints, const std::vector<paths::PathPlanner>& theirs,
                    const std::vector<Teammate>& who);

/// To come after those who aim at the same: the way of `decision` cut kBehind_m short of its goal, or, where
/// it is no longer than that, to wait for a second.
Decision comingAfter(Decision decision, const core::Pose2& T_map_robot);
inline constexpr double kBehind_m = 2.5;

/// Nothing is left but what others are at: to wait for a second.
Decision waitingForOthers(const std::string& reason);

}  // namespace slam::choices
