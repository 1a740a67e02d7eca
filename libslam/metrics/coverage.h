#pragma once
#include <cstddef>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/metrics/map_score.h"
#include "libslam/world/plan.h"

namespace slam::metrics {

/// What of a plan a robot can explore from where it stands: the denominator of every share of coverage.
///
/// Reachable are the cells at whose centre the robot's disc touches no wall and stays in the plan (unknown
/// cells are no wall), 4-connected through such cells with the start's own cell or one of its eight
/// neighbours; a passage in which no cell's centre leaves the disc room is shut. Explorable are the free
/// cells that are reachable or can be seen from a reachable one within the lidar's range. Sight works both
/// ways, so it is asked from the seen cell: kSightRays exact rays leave its centre, and one of them has to
/// enter a reachable cell before a wall. A cell seen only through less than the angle between two of these
/// rays is left out: from there it is no more than a sliver. The lidar's field of view and its place on the
/// robot do not matter, for the robot can turn.
struct ExplorableArea {
  int columns = 0, rows = 0;
  std::vector<unsigned char> explorable;  ///< row-major as Plan::cells; 1 = explorable
  std::size_t cells = 0;                  ///< how many of them
  double area_m2 = 0;
  double share_of_free = 0;  ///< of all free cells of the plan: small when the start is cut off; NaN without
};
inline constexpr int kSightRays = 720;

/// max_range_m <= 0 means no limit. A start that is not finite, in a wall or outside the plan can explore
/// nothing. Cost: seconds for a plan of 2000 x 2000 cells.
ExplorableArea explorableArea(const world::Plan& plan, const core::Point2& start_world, double radius_m,
                              double max_range_m);

/// What has been explored so far: the explorable cells that exact rays of the scans have crossed, from the
/// true pose of every scan. Rays count whether their reading was lost or not.
class Coverage {
 public:
  /// Keeps a reference to `plan`, which must outlive it. REQUIRES an area of that plan (ContractError).
  Coverage(const world::Plan& plan, ExplorableArea area);
  Coverage(world::Plan&&, ExplorableArea) = delete;

  /// One more scan; returns the explorable cells that are new. Beams as in rays::castScan(). A pose that is
  /// not finite, outside the plan or in a wall sees nothing. Cost: the cells along the beams.
  std::size_t look(const core::Pose2& T_world_lidar, double first_angle_rad, double step_rad, int beams,
                   double max_range_m);

  double area_m2() const;
  double share() const;  ///< of the explorable area, 0 to 1; NaN where nothing is explorable
  const ExplorableArea& explorable() const { return area_; }
  /// All that was seen, explorable or not, for scoreMap().
  SeenMask seen() const;

 private:
  const world::Plan& plan_;
  ExplorableArea area_;
  std::vector<unsigned char> seen_;
  std::size_t explored_ = 0;
  core::Pose2 last_look_;
};

/// The state of an exploration after a scan.
struct CoveragePoint {
  double time_s = 0;  ///< since the first scan
  double path_m = 0;  ///< truly driven
  std::size_t scans = 0;
  double explored_m2 = 0;
};

/// An exploration in figures. NaN: that share was never reached.
struct ExplorationFigures {
  double coverage;  ///< explored share at the end; NaN where nothing is explorable
  double time_s, path_m;
  std::size_t scans;
  double t90_s, t99_s;  ///< first time at which 90 % and 99 % of the explorable area were explored
  double path90_m, path99_m, scans90, scans99;
  /// Share of the path that adds no new area (the original document asks to come back as little as possible):
  /// the path is cut after every scan that completes kRedundancyPiece_m, and a piece counts as redundant when
  /// the scans along it add less than kNewArea_m2pm times its length. The last piece may be shorter. NaN for
  /// a robot that never moved.
  double redundant_share;
};
inline constexpr double kRedundancyPiece_m = 1.0;
/// Less than this is the odd cell in a corner, not new area: a robot that clears a strip of its own width
/// (half a metre) has five times as much.
inline constexpr double kNewArea_m2pm = 0.1;

/// `curve`: in the order of the scans. Empty: everything NaN or 0.
ExplorationFigures explorationFigures(const std::vector<CoveragePoint>& curve, double explorable_m2);

}  // namespace slam::metrics
