#pragma once
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/draw/curves.h"
#include "libslam/explore/explore.h"
#include "libslam/oracle/known_map_tour.h"
#include "libslam/world/plan.h"

namespace slam::explore {

/// What somebody who knows the plan would have to drive, for the robot, lidar and start of this
/// configuration. Errors: a camera in place of the lidar, whose view the oracle does not know (InputError).
oracle::Oracle askOracle(const world::Plan& plan, const ExploreConfig& config, core::Progress& progress);
/// Puts its lengths beside a run's own.
void compareWith(const oracle::Oracle& oracle, Exploration& exploration);
/// Explored share over path of the tour to 99 %, or to 90 % where there is none, as a curve of coverage.png.
draw::Curve oracleCurve(const oracle::Oracle& oracle);
/// oracle.csv: both tours, place by place with what they had seen; oracle.png: them on the plan.
void writeOracle(const oracle::Oracle& oracle, const world::Plan& plan, const std::string& folder);
/// "Known map: 90 % after 10.5 m, ..." for the notes of tables.
std::string oracleNote(const oracle::Oracle& oracle);

}  // namespace slam::explore
