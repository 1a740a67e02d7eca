#pragma once
#include <functional>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/metrics/coverage.h"
#include "libslam/world/plan.h"

namespace slam::oracle {

/// The robot and the lidar that a tour is for.
struct TourRequest {
  core::Point2 start_world;
  double radius_m = 0.35;          ///< of the disc around the footprint
  double lidar_offset_m = 0;       ///< of the lidar from the robot's centre; counts for the bound from below
  double max_range_m = 0;          ///< of the lidar; <= 0: no limit
  double beam_step_rad = 0.00873;  ///< angle between two beams
  int rounds = 300;                ///< of the search, for each share
};

struct TourPoint {
  double path_m = 0, share = 0;
};

/// A tour of somebody who knows the plan, and what it sees.
struct KnownMapTour {
  double share = 0;                ///< of the explorable area that it was made for
  double length_m = 0;             ///< until that share is explored; NaN when it never is
  std::vector<core::Point2> path;  ///< world frame, the start first; it ends where the share is reached
  std::vector<TourPoint> curve;    ///< explored share over path, every kCurveStep_m
};
inline constexpr double kCurveStep_m = 0.1;

/// Between what lengths the shortest path lies that explores 90 % and 99 % of the plan, for this robot from
/// this start. Explored is what metrics::Coverage counts, of the same explorable area as in every exploration
/// table.
///
/// From above: tours that were found (see CoverSearch) and then driven on the plan, one for each share. The
/// robot keeps to cells that metrics::explorableArea() calls reachable and looks all round every
/// kCurveStep_m, beams as dense as the lidar's: turning costs time, not path, so a lidar with any field of
/// view could do the same. Nobody who is scored by his path has to need more; a shorter tour may exist.
///
/// From below: see boundBelow().
struct Oracle {
  KnownMapTour to_90, to_99;
  double below_90_m = 0, below_99_m = 0;
};

/// `go_on` is asked now and then: it may throw. The same every time. Cost: from seconds (a flat) to about a
/// minute (42 m x 27 m of offices). A start that can explore nothing gives tours of length NaN.
Oracle consultOracle(
    const world::Plan& plan, const metrics::ExplorableArea& area, const TourRequest& request,
    const std::function<void()>& go_on = [] {});

}  // namespace slam::oracle
