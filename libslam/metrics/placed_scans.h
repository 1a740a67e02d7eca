#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/cell_map.h"

namespace slam::metrics {

/// How sharp the points of all scans lie together when each scan is placed at its estimated pose. No truth,
/// no raster.
///
/// Local consistency only: scans that agree with their neighbours score well, whatever the map's global
/// distortion. What it sees is walls drawn twice, a loop that does not close, headings that jitter. The
/// sensor's noise and what moved are in it, so compare trajectories of one log only.
struct PointSharpness {
  /// Mean map entropy (Droeschel and Behnke, ICRA 2018, section on evaluation; in the plane): the mean over
  /// the points of h = ln det(2 pi e S) / 2, nats, with S the covariance (divided by n) of the points within
  /// kNeighbourhood_m, the point itself included. Smaller is sharper; ln 2 less is half the area of the
  /// spread. Differs from the authors' program in two things: points with fewer than kFewestNeighbours others
  /// around are left out (it lets them in as 0), and a variance of kSmallestSpread_m squared is added along
  /// both axes, so that points on one line have an entropy.
  double mean_map_entropy;
  /// Median over the same points of the square root of S's smaller eigenvalue, metres: how far the points
  /// around lie from the line through them. Ours; the authors' "mean plane variance" has the same use.
  double wall_thickness_m;
  std::size_t points;        ///< whose neighbourhood was looked at
  std::size_t left_out = 0;  ///< of these, with too few neighbours
};
inline constexpr double kNeighbourhood_m = 0.3;  ///< as the authors' program has it
inline constexpr std::size_t kFewestNeighbours = 5;
inline constexpr double kSmallestSpread_m = 0.001;

/// Looks at `most` of the points, evenly spread over the map, among all of them as neighbours. Points that
/// are not finite are passed over. No point with neighbours: both figures NaN. REQUIRES most > 0. Cost: about
/// a second for a million points, and no memory beside the points themselves.
PointSharpness pointSharpness(std::vector<core::Point2> points, std::size_t most = 20000);

/// How well scans placed at the estimated poses agree with the map that was made from them (scan-to-map
/// consistency). The two shares are ours; the idea is that of the likelihood field and of the beam model
/// (Thrun, Burgard and Fox, Probabilistic Robotics, 2005, chapter 6) without their mixture weights. Both are
/// shares of the returns that lie inside the map's raster; NaN without any.
struct ScanAgreement {
  /// Ends within kWallReach_m of the centre of an occupied cell: low where poses and map do not belong
  /// together, where walls were drawn and erased again, where people walked.
  double on_wall_share;
  /// Comes out of an occupied cell again and crosses kWallReach_m or more of what the map calls free before
  /// it ends: high where a wall is drawn twice. Grazing beams and glass are in it, and every beam of a lidar
  /// that the map puts into a wall.
  double through_wall_share;
  std::size_t returns = 0;
};
inline constexpr double kWallReach_m = 0.10;

/// Collects scans one by one, in memory that a long drive does not use up: once the scans used have more than
/// `most_points` returns, half of them are dropped, and of those to come as many are passed over. What is
/// left lies evenly over the whole drive and over all lidars.
class PlacedScans {
 public:
  /// Keeps a reference to the map, which must outlive it. Poses and points are in its frame.
  explicit PlacedScans(const world::CellMap& map, std::size_t most_points = kMostPoints)
      : map_(map), most_points_(most_points) {}
  explicit PlacedScans(world::CellMap&&, std::size_t = kMostPoints) = delete;
  static constexpr std::size_t kMostPoints = 3'000'000;  ///< 48 MB

  /// One scan: returns as points in the lidar's frame. So that a robot that stands still does not outvote one
  /// that drives, a scan is passed over when its pose is within 0.1 m and 5 degrees of the last one that was
  /// not; a pose that is not finite too. Cost: the cells along the beams of scans that are used.
  void add(const core::Pose2& T_map_lidar, const std::vector<core::Point2>& returns_lidar);

  ScanAgreement agreement() const;
  /// All returns of the scans used, in the map frame; 16 bytes each.
  const std::vector<core::Point2>& points() const { return points_; }
  /// The same, which are here no more; what was said of the scans stays.
  std::vector<core::Point2> takePoints() { return std::move(points_); }
  /// How often the scans used were halved.
  int halvings() const { return halvings_; }

 private:
  bool endsOnWall(const core::Point2& end_cells) const;
  bool goesThroughWall(const core::Point2& origin_cells, const core::Point2& end_cells) const;
  bool isKept(std::uint64_t view) const;
  void dropHalf();

  struct Used {
    std::uint64_t view;
    std::size_t points;  ///< of points_, up to and with this scan
    std::uint32_t returns = 0, on_wall = 0, through_wall = 0;
  };

  const world::CellMap& map_;
  std::size_t most_points_;
  core::Pose2 last_view_;
  std::uint64_t views_ = 0;
  int halvings_ = 0;
  std::vector<core::Point2> points_;
  std::vector<Used> used_;
};

}  // namespace slam::metrics
