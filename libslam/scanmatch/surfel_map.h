#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/scanmatch/scan_points.h"

namespace slam::scanmatch {

/// The points of several scans as one Gaussian per cell, pooled over the cell's neighbourhood: on a wall a
/// flat one, in clutter a round one (the normal distributions transform: Biber and Strasser, IROS 2003).
struct Surfel {
  float x, y;        ///< mean, from the map's origin
  float xx, xy, yy;  ///< information matrix (inverse covariance), 1/m^2
  /// A wall whose two faces were both seen, apart from each other, has a surfel of each: the mean of the unit
  /// normals of this one's points, towards the lidar, and the index of the other; -1: one face only. (0, 0)
  /// in a map that does not keep faces apart.
  float nx, ny;
  std::int32_t back;
};

/// A neighbourhood this flat (variance across to along) is a wall.
inline constexpr double kFlat = 0.15;

/// Mean and covariance of points: half of what the variances differ by, the mixed term, the root of the sum
/// of both squares; along the direction of most spread, and across it (m^2).
struct Spread {
  double mx, my, half, xy, root, along, across;
};

/// The points of a scan at a pose, those in a row that fall into one cell and are seen from one side summed
/// up: what maps take in, for a scan that several of them hold.
class ScanInCells {
 public:
  /// Points in the robot frame, cells of the map frame. Uses the memory that is there already.
  void sort(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot, double cell_m);

  struct Sums {
    double n = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;  ///< from the centre of the cell
    double nx = 0, ny = 0;                               ///< normals, towards the lidar
    /// Adds the sums of a neighbour with a weight; its cell lies (ox, oy) off this one.
    void add(const Sums& sums, double w, double ox, double oy) {
      n += w * sums.n;
      x += w * (sums.x + sums.n * ox), y += w * (sums.y + sums.n * oy);
      xx += w * (sums.xx + 2 * ox * sums.x + sums.n * ox * ox);
      xy += w * (sums.xy + ox * sums.y + oy * sums.x + sums.n * ox * oy);
      yy += w * (sums.yy + 2 * oy * sums.y + sums.n * oy * oy);
      nx += w * sums.nx, ny += w * sums.ny;
    }
    /// REQUIRES points.
    Spread spread() const {
      const double per_point = 1 / n, mx = x * per_point, my = y * per_point;
      const double var_x = xx * per_point - mx * mx, var_y = yy * per_point - my * my,
                   var_xy = xy * per_point - mx * my;
      const double half = (var_x - var_y) / 2, root = std::sqrt(half * half + var_xy * var_xy);
      return {
          mx, my, half, var_xy, root, (var_x + var_y) / 2 + root, std::max((var_x + var_y) / 2 - root, 0.0)};
    }
  };
  struct Run {
    std::int64_t column, row;  ///< of the plane: the cell (0, 0) begins at the origin of the map frame
    Sums sums;
  };
  const std::vector<Run>& runs() const { return runs_; }

 private:
  friend class SurfelMap;
  std::vector<Run> runs_;
};

/// A square window of such cells, in the map frame (m). Points per cell are kept, and surfels made of them on
/// demand.
class SurfelMap {
 public:
  /// Cells of `cell_m`; `blur_m` is added to every Gaussian as an isotropic standard deviation. `two_sided`:
  /// the faces of a thin wall are kept apart; without it they are fused, which a coarse match from far off
  /// needs. `widens`: where a neighbourhood of a wall holds few points of several scans a wider one is
  /// pooled, so that they tell which way the wall runs; for a robot that is tracked, as a map of few points
  /// then explains a wrong place better, too.
  SurfelMap(double cell_m, double blur_m, bool two_sided = false, bool widens = false)
      : cell_m_(cell_m), blur_m_(blur_m), two_sided_(two_sided), widens_(widens) {}

  /// Empty, covering [centre - reach, centre + reach] in both directions; points outside are left out.
  void clear(const core::Point2& centre, double reach_m);
  /// Points of a scan, robot frame. `view` names the scan for firstViewOf().
  void add(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot, int view = 0);
  /// The same, sorted before. REQUIRES cells of this size.
  void add(const ScanInCells& scan, int view = 0);
  /// The points of a map of smaller cells, each cell of which lies within one of these.
  void add(const SurfelMap& finer);

  core::Point2 origin() const { return origin_; }
  /// Whether the map has anything to say there: see clear(). Coordinates from origin().
  bool covers(double x, double y) const { return x >= 0 && y >= 0 && x < extent_m_ && y < extent_m_; }
  /// nullptr where no surface is near. Coordinates from origin(). Of a wall with two faces the one that was
  /// seen first. A surfel is made when it is first asked for, so that two threads must not ask the same map.
  const Surfel* at(double x, double y) const {
    if (!(x >= 0 && y >= 0 && x < extent_m_ && y < extent_m_)) return nullptr;
    const auto column = static_cast<std::int64_t>(x * per_cell_),
               row = static_cast<std::int64_t>(y * per_cell_);
    const std::int64_t cell = row * side_ + column;
    std::int32_t index = surfel_of_[static_cast<size_t>(cell)];
    if (index == kUnknown) index = makeSurfel(cell);
    return index < 0 ? nullptr : &surfels_[static_cast<size_t>(index)];
  }
  /// The same for a point whose surface has this normal (of any length; towards the lidar): the face on its
  /// side. Where a map of two faces has seen a wall from the other side alone, the point lies behind that by
  /// the wall's thickness, which is not known: `share` of the surfel's information is left.
  struct Facing {
    const Surfel* surfel = nullptr;
    double share = 1;
  };
  Facing facing(double x, double y, double nx, double ny) const {
    const Surfel* surfel = at(x, y);
    if (!surfel) return {};
    const double along = surfel->nx * nx + surfel->ny * ny;
    if (along >= 0) return {surfel};
    if (surfel->back >= 0) return {&surfels_[static_cast<size_t>(surfel->back)]};
    const double own2 = surfel->nx * surfel->nx + surfel->ny * surfel->ny;
    if (own2 < kOneSided * kOneSided || 4 * along * along < own2 * (nx * nx + ny * ny)) return {surfel};
    return {surfel, 1 / (1 + kThickness_m * kThickness_m * static_cast<double>(surfel->xx + surfel->yy))};
  }
  /// The least of the views whose points made the surfel that at() gave last.
  int firstViewOf(const Surfel& surfel) const {
    return first_views_[static_cast<size_t>(&surfel - surfels_.data())];
  }
  /// What a wall's surfel seems to tell of where along the wall one is, and does not, 1/m^2: its direction
  /// errs, by the variance across over that along and the number of points, so that the square of its normal
  /// has a part along the wall.
  float feignedBy(const Surfel& surfel) const {
    return feigned_[static_cast<size_t>(&surfel - surfels_.data())];
  }

 private:
  struct Sums : ScanInCells::Sums {
    std::int32_t back = -1;  ///< of the points seen from the other side
    std::int32_t first_view = std::numeric_limits<std::int32_t>::max();
  };
  static constexpr std::int32_t kUnknown = -1, kNone = -2;
  /// Points that were all seen from one side have normals whose mean is at least this long: half a unit, as
  /// far as normals may point apart that are not opposite.
  static constexpr double kOneSided = 0.5;
  static constexpr double kThickness_m = 0.1;  ///< of the walls of buildings, roughly
  struct Faces {
    Sums front, back;
  };
  struct Cell {
    std::int32_t column, row;
  };
  std::int64_t at(const Cell& cell) const { return cell.row * side_ + cell.column; }
  void pool(std::int64_t cell, int reach, Faces& faces) const;
  static bool isFlat(const Faces& faces);
  std::int32_t makeSurfel(std::int64_t cell) const;
  static bool areTwoFaces(const Sums& front, const Sums& back);
  std::int32_t indexOf(std::int64_t column, std::int64_t row);
  Sums& faceOf(std::int32_t index, const ScanInCells::Sums& seen);
  void pushSurfel(const Sums& pooled, std::int64_t column, std::int64_t row) const;

  double cell_m_, blur_m_;
  bool two_sided_, widens_;
  double per_cell_ = 0, extent_m_ = 0;
  core::Point2 origin_;
  std::int64_t first_column_ = 0, first_row_ = 0;  ///< of the plane
  std::int64_t side_ = 0;
  ScanInCells scan_;                             ///< scratch of add()
  int scans_ = 0;                                ///< taken in since clear()
  std::vector<std::int32_t> sums_of_;            ///< per cell, -1: no point
  mutable std::vector<std::int32_t> surfel_of_;  ///< per cell
  std::vector<Sums> sums_;
  std::vector<Cell> cells_;                        ///< those with points
  mutable std::vector<std::int64_t> asked_cells_;  ///< where surfel_of_ is known
  mutable std::vector<Surfel> surfels_;
  mutable std::vector<std::int32_t> first_views_;  ///< of surfels_
  mutable std::vector<float> feigned_;             ///< of them
};

}  // namespace slam::scanmatch
