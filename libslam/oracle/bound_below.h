#pragma once
#include <functional>

#include "libslam/metrics/coverage.h"
#include "libslam/world/plan.h"

namespace slam::oracle {

/// No path that explores 90 %, and none that explores 99 %, is shorter than these.
struct BoundBelow {
  double below_90_m = 0, below_99_m = 0;
};

/// For a disc whose lidar sits within lidar_offset_m of its centre and may look all round, from this start.
///
/// Why nothing is shorter:
/// 1. The centre of the robot only ever lies in cells at whose middle a disc fits that is smaller by half a
///    cell's diagonal: F, those 8-connected with the start's. A set of explorable cells is given to a group,
///    and the group's region is every cell of F that holds a point from which a point of one of these cells
///    is in sight (visitSeeing(), which leaves out no line of sight). Who never enters the region sees none
///    of the group. Regions are chosen so that no two share a cell.
/// 2. A piece of path shorter than a cell's side ends in the cell where it began or in one of the eight
///    around it. So a path between two regions that are h moves of a chess king apart within F is at least
///    h - 1 cells long.
/// 3. Who explores the share q misses groups of at most 1 - q of the area together. Let y_S >= 0 be given to
///    sets S of groups such that for every pair of groups the y of the sets that hold one of the two and not
///    the other (the start is in none) add up to at most the distance of 2, and for every S twice the y of
///    all subsets of S add up to at most lambda times S's area. The path crosses the border of every S of
///    which it enters a group: once at least, and twice unless it ends in S. So its length, and lambda times
///    the area that it misses, are at least 2 sum y_S minus the largest sum of the y of sets around one
///    group; hence the bound, for any lambda >= 0. The y are grown as moats (Goemans and Williamson, "A
///    general approximation technique for constrained forest problems", SIAM J. Comput. 24(2), 1995).
/// Regions of several sizes and many lambdas are tried, and the best bound is kept. By 1 and 2 alone, no path
/// is shorter than the way to the nearest place in sight of any block, for those blocks that together are
/// more than may be missed; where that is more it counts. The bound may lie far below the optimum, because
/// the thinnest line of sight from afar counts as seen, and what it costs to move within a region as nothing.
///
/// `go_on` is asked now and then: it may throw. Cost: seconds.
BoundBelow boundBelow(const world::Plan& plan, const metrics::ExplorableArea& area,
                      const core::Point2& start_world, double radius_m, double lidar_offset_m,
                      double max_range_m, const std::function<void()>& go_on);

}  // namespace slam::oracle
