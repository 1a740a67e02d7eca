#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/paths/path_planner.h"

namespace slam::choices {

/// A place to look from.
struct Viewpoint {
  paths::PathPlanner::Node node = 0;
  core::Point2 p_map;
  std::vector<paths::PathPlanner::Node> way;  ///< from the robot
  double length_m = 0;                        ///< of the way
  double cost_m = 0;                          ///< of the way, in metres of comfortable driving
  std::size_t frontier = 0;                   ///< which of strategies::Prospects::frontiers it is for
  bool at_frontier = true;  ///< as near to the frontier as the robot can; else on the way there
};

}  // namespace slam::choices
