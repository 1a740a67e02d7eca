#pragma once
#include <cstdint>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/scanmatch/scan_points.h"

namespace slam::scanmatch {

/// The points of several scans as one Gaussian per cell, pooled over the cell's neighbourhood: on a wall a flat one,
/// in clutter a round one (the normal distributions transform: Biber and Strasser, IROS 2003).
struct Surfel {
  float x, y;        ///< mean, from the map's origin
  float xx, xy, yy;  ///< information matrix (inverse covariance), 1/m^2
};

/// A square window of such cells, in the map frame (m). Points per cell are kept, and surfels made of them on demand.
class SurfelMap {
 public:
  /// Cells of `cell_m`; `blur_m` is added to every Gaussian as an isotropic standard deviation.
  SurfelMap(double cell_m, double blur_m) : cell_m_(cell_m), blur_m_(blur_m) {}

  /// Empty, covering [centre - reach, centre + reach] in both directions; points outside are left out.
  void clear(const core::Point2& centre, double reach_m);
  /// Points of a scan, robot frame.
  void add(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot);

  core::Point2 origin() const { return origin_; }
  /// Whether the map has anything to say there: see clear(). Coordinates from origin().
  bool covers(double x, double y) const { return x >= 0 && y >= 0 && x < extent_m_ && y < extent_m_; }
  /// nullptr where no surface is near. Coordinates from origin(). A surfel is made when it is first asked for, so that
  /// two threads must not ask the same map.
  const Surfel* at(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < extent_m_ && y < extent_m_)) return nullptr;
    const auto column = static_cast<std::int64_t>(x * per_cell_),
               row = static_cast<std::int64_t>(y * per_cell_);
    const std::int64_t cell = row * side_ + column;
    std::int32_t index = surfel_of_[static_cast<size_t>(cell)];
    if (index == kUnknown) index = makeSurfel(cell);
    return index < 0 ? nullptr : &surfels_[static_cast<size_t>(index)];
  }

 private:
  struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  ///< from the centre of the cell
  };
  static constexpr std::int32_t kUnknown = -1, kNone = -2;
  std::int32_t makeSurfel(std::int64_t cell) const;

  double cell_m_, blur_m_, per_cell_ = 0, extent_m_ = 0;
  core::Point2 origin_;
  std::int64_t side_ = 0;
  std::vector<std::int32_t> sums_of_;            ///< per cell, -1: no point
  mutable std::vector<std::int32_t> surfel_of_;  ///< per cell
  std::vector<Sums> sums_;
  std::vector<std::int64_t> cells_;                ///< of sums_
  mutable std::vector<std::int64_t> asked_cells_;  ///< where surfel_of_ is known
  mutable std::vector<Surfel> surfels_;
};

}  // namespace slam::scanmatch
