#include "libslam/scanmatch/surfel_map.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::scanmatch {
namespace {

/// A neighbourhood this flat (variance across to along) is a wall.
constexpr double kFlat = 0.15;
/// Two faces of a wall have so many points each, at least, and their means are so many standard deviations
/// apart, squared.
constexpr double kLeastOfFace = 3, kApart2 = 4;
/// Fewer points, each by its weight, say little of which way a wall runs: then a wider neighbourhood is
/// pooled, evenly, if it is flat. With 5 to 12 here maps of sparse scans are about as good.
constexpr double kFewPoints = 6;
constexpr int kNear = 1, kWide = 2;
/// In a map of one scan a wide surfel is no surer than its points, and explains wrong places, too.
constexpr int kLeastScans = 2;
/// On the mixed term: more than what rounding to float may take off the determinant, so that a surfel's
/// information is positive semidefinite as it is stored.
constexpr double kHeldBack = 1 - 2.5e-7;

/// Whether two directions are more than 120 degrees apart: normals of single points err much.
bool areOpposite(double ax, double ay, double bx, double by) {
  const double dot = ax * bx + ay * by;
  return dot < 0 && 4 * dot * dot > (ax * ax + ay * ay) * (bx * bx + by * by);
}

/// Column or row of a coordinate from the map's corner. Below 0 it may be one too high: that is rim still.
std::int64_t cellOf(double at_m, double per_cell) {
  return static_cast<std::int64_t>(at_m * per_cell);
}

}  // namespace

void SurfelMap::clear(const core::Point2& centre, double reach_m) {
  const auto side = static_cast<std::int64_t>(std::ceil(2 * reach_m / cell_m_)) + 6;
  if (side != side_) {
    side_ = side;
    sums_of_.assign(static_cast<size_t>(side * side), -1);
    surfel_of_.assign(static_cast<size_t>(side * side), kUnknown);
  } else {
    for (const auto cell : cells_) sums_of_[static_cast<size_t>(cell)] = -1;
    for (const auto cell : asked_cells_) surfel_of_[static_cast<size_t>(cell)] = kUnknown;
  }
  per_cell_ = 1 / cell_m_;
  extent_m_ = (static_cast<double>(side_) - 0.5) * cell_m_;
  origin_ = {(std::floor((centre.x - reach_m) * per_cell_) - 3) * cell_m_,
             (std::floor((centre.y - reach_m) * per_cell_) - 3) * cell_m_};
  sums_.clear(), cells_.clear(), surfels_.clear(), first_views_.clear(), feigned_.clear(),
      asked_cells_.clear();
  scans_ = 0;
}

void SurfelMap::add(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot, int view) {
  const auto [s, c] = core::sinCos(T_map_robot.phi);
  const double tx = T_map_robot.x - origin_.x, ty = T_map_robot.y - origin_.y;
  ++scans_;
  for (const auto& point : points) {
    const double x = tx + c * point.x - s * point.y, y = ty + s * point.x + c * point.y;
    const auto column = cellOf(x, per_cell_), row = cellOf(y, per_cell_);
    const std::int32_t index = indexOf(column, row);
    if (index < 0) continue;
    const double dx = x - (static_cast<double>(column) + 0.5) * cell_m_;
    const double dy = y - (static_cast<double>(row) + 0.5) * cell_m_;
    const double ax = c * point.along_x - s * point.along_y, ay = s * point.along_x + c * point.along_y;
    Sums& sums = two_sided_ ? faceOf(index, ax, ay) : sums_[static_cast<size_t>(index)];
    sums.first_view = std::min(sums.first_view, view);
    sums.n += 1, sums.x += dx, sums.y += dy;
    sums.xx += dx * dx + ax * ax, sums.xy += dx * dy + ax * ay, sums.yy += dy * dy + ay * ay;
  }
}

void SurfelMap::add(const SurfelMap& finer) {
  scans_ += finer.scans_;
  for (const std::int64_t cell : finer.cells_) {
    const std::int64_t rows_below = cell / finer.side_;
    const double its_column = static_cast<double>(cell % finer.side_),
                 its_row = static_cast<double>(rows_below);
    const double x = finer.origin_.x + (its_column + 0.5) * finer.cell_m_ - origin_.x,
                 y = finer.origin_.y + (its_row + 0.5) * finer.cell_m_ - origin_.y;
    const auto column = cellOf(x, per_cell_), row = cellOf(y, per_cell_);
    const std::int32_t index = indexOf(column, row);
    if (index < 0) continue;
    const double ox = x - (static_cast<double>(column) + 0.5) * cell_m_,
                 oy = y - (static_cast<double>(row) + 0.5) * cell_m_;
    for (std::int32_t face = finer.sums_of_[static_cast<size_t>(cell)]; face >= 0;
         face = finer.sums_[static_cast<size_t>(face)].back)
      sums_[static_cast<size_t>(index)].add(finer.sums_[static_cast<size_t>(face)], 1, ox, oy);
  }
}

/// Where the sums of a cell are; -1 on the rim, which stays empty so that neighbours need no check.
std::int32_t SurfelMap::indexOf(std::int64_t column, std::int64_t row) {
  if (column < 2 || row < 2 || column >= side_ - 2 || row >= side_ - 2) return -1;
  const std::int64_t cell = row * side_ + column;
  std::int32_t& index = sums_of_[static_cast<size_t>(cell)];
  if (index < 0) {
    index = static_cast<std::int32_t>(sums_.size());
    sums_.emplace_back();
    cells_.push_back(cell);
  }
  return index;
}

/// The sums of a cell for a point whose surface lies along (ax, ay), with the lidar on the left.
SurfelMap::Sums& SurfelMap::faceOf(std::int32_t index, double ax, double ay) {
  const double length = std::sqrt(ax * ax + ay * ay);
  const double nx = length > 0 ? -ay / length : 0, ny = length > 0 ? ax / length : 0;
  auto face = static_cast<size_t>(index);
  if (areOpposite(sums_[face].nx, sums_[face].ny, nx, ny)) {
    if (sums_[face].back < 0) {
      sums_[face].back = static_cast<std::int32_t>(sums_.size());
      sums_.emplace_back();
    }
    face = static_cast<size_t>(sums_[face].back);
  }
  sums_[face].nx += nx, sums_[face].ny += ny;
  return sums_[face];
}

/// Whether points seen from opposite sides lie apart, each on its own side: otherwise they are one thin or
/// rough thing.
bool SurfelMap::areTwoFaces(const Sums& front, const Sums& back) {
  if (front.n < kLeastOfFace || back.n < kLeastOfFace) return false;
  // From back to front, of any length: both sides of the comparison grow with its square.
  const double dx = front.nx / front.n - back.nx / back.n, dy = front.ny / front.n - back.ny / back.n;
  const double apart =
      dx * (front.x / front.n - back.x / back.n) + dy * (front.y / front.n - back.y / back.n);
  const auto variance = [&](const Sums& sums) {
    const double mx = sums.x / sums.n, my = sums.y / sums.n;
    return dx * dx * (sums.xx / sums.n - mx * mx) + 2 * dx * dy * (sums.xy / sums.n - mx * my) +
           dy * dy * (sums.yy / sums.n - my * my);
  };
  return apart > 0 && apart * apart > kApart2 * (variance(front) + variance(back));
}

/// Adds the sums of a neighbour with a weight; its cell lies (ox, oy) off this one.
void SurfelMap::Sums::add(const Sums& sums, double w, double ox, double oy) {
  n += w * sums.n;
  x += w * (sums.x + sums.n * ox), y += w * (sums.y + sums.n * oy);
  xx += w * (sums.xx + 2 * ox * sums.x + sums.n * ox * ox);
  xy += w * (sums.xy + ox * sums.y + oy * sums.x + sums.n * ox * oy);
  yy += w * (sums.yy + 2 * oy * sums.y + sums.n * oy * oy);
  nx += w * sums.nx, ny += w * sums.ny;
  first_view = std::min(first_view, sums.first_view);
}

SurfelMap::Spread SurfelMap::Sums::spread() const {
  const double mx = x / n, my = y / n;
  const double var_x = xx / n - mx * mx, var_y = yy / n - my * my, var_xy = xy / n - mx * my;
  const double half = (var_x - var_y) / 2, root = std::sqrt(half * half + var_xy * var_xy);
  return {mx, my, half, var_xy, root, (var_x + var_y) / 2 + root, std::max((var_x + var_y) / 2 - root, 0.0)};
}

/// Whether they lie along one wall, whichever side they were seen from.
bool SurfelMap::isFlat(const Faces& faces) {
  Sums all = faces.front;
  all.add(faces.back, 1, 0, 0);
  const Spread spread = all.spread();
  return spread.across < kFlat * spread.along;
}

/// The points of a cell's neighbourhood, `reach` cells to each side, from the centre of the cell. REQUIRES
/// that it lies within the map.
SurfelMap::Faces SurfelMap::pooled(std::int64_t cell, int reach) const {
  Faces faces;
  double nx = 0, ny = 0;  // of the front
  const auto add = [&](std::int32_t first, double w, double ox, double oy) {
    for (std::int32_t at = first; at >= 0; at = sums_[static_cast<size_t>(at)].back) {
      const Sums& sums = sums_[static_cast<size_t>(at)];
      if (nx == 0 && ny == 0) nx = sums.nx, ny = sums.ny;
      (two_sided_ && areOpposite(nx, ny, sums.nx, sums.ny) ? faces.back : faces.front).add(sums, w, ox, oy);
    }
  };
  if (const std::int32_t own = sums_of_[static_cast<size_t>(cell)]; own >= 0)
    nx = sums_[static_cast<size_t>(own)].nx, ny = sums_[static_cast<size_t>(own)].ny;
  const double beside = reach == kNear ? 0.5 : 1;
  for (int r = -reach; r <= reach; ++r)
    for (int k = -reach; k <= reach; ++k)
      add(sums_of_[static_cast<size_t>(cell + r * side_ + k)],
          (r == 0 ? 1.0 : beside) * (k == 0 ? 1.0 : beside), k * cell_m_, r * cell_m_);
  return faces;
}

std::int32_t SurfelMap::makeSurfel(std::int64_t cell) const {
  std::int32_t& index = surfel_of_[static_cast<size_t>(cell)];
  asked_cells_.push_back(cell);
  index = kNone;
  // The rim is empty, and its cells have no neighbours to ask.
  const std::int64_t column = cell % side_, row = cell / side_;
  const auto isWithin = [&](int reach) {
    return column >= reach && row >= reach && column < side_ - reach && row < side_ - reach;
  };
  if (!isWithin(kNear)) return index;
  auto [front, back] = pooled(cell, kNear);
  const double count = front.n + back.n;
  if (widens_ && scans_ >= kLeastScans && count > 0 && count < kFewPoints && isWithin(kWide)) {
    const Faces wide = pooled(cell, kWide);
    if (isFlat(wide)) front = wide.front, back = wide.back;
  }
  if (front.n + back.n < 2) return index;
  index = static_cast<std::int32_t>(surfels_.size());
  const bool are_two = areTwoFaces(front, back);
  if (!are_two) front.add(back, 1, 0, 0);
  pushSurfel(front, column, row);
  if (are_two) {
    surfels_.back().back = index + 1;
    pushSurfel(back, column, row);
  }
  return index;
}

/// The surfel of these points, from the centre of the cell.
void SurfelMap::pushSurfel(const Sums& pooled, std::int64_t column, std::int64_t row) const {
  const auto [mx, my, half, xy, root, along, across] = pooled.spread();
  const double blur2 = blur_m_ * blur_m_;
  // A wall says nothing of where along it one stands, although the points of one cell have a middle.
  const double information_across = 1 / (across + blur2);
  const double information_along = across < kFlat * along ? 0 : 1 / (along + blur2);
  // Unit vector along, from the row that does not cancel.
  double ux = half >= 0 ? half + root : xy, uy = half >= 0 ? xy : root - half;
  const double length = std::sqrt(ux * ux + uy * uy);
  if (length > 0)
    ux /= length, uy /= length;
  else
    ux = 1, uy = 0;
  const double gain = information_along - information_across;
  const double cx = (static_cast<double>(column) + 0.5) * cell_m_;
  const double cy = (static_cast<double>(row) + 0.5) * cell_m_;
  // Sums of what is not negative: a difference would lose what a wall next to parallel to an axis tells along
  // that axis, and with it that the information is positive semidefinite.
  surfels_.push_back({static_cast<float>(cx + mx), static_cast<float>(cy + my),
                      static_cast<float>(information_along * ux * ux + information_across * uy * uy),
                      static_cast<float>(kHeldBack * gain * ux * uy),
                      static_cast<float>(information_along * uy * uy + information_across * ux * ux),
                      static_cast<float>(pooled.nx / pooled.n), static_cast<float>(pooled.ny / pooled.n),
                      -1});
  first_views_.push_back(pooled.first_view);
  // The direction of a line through n points errs by this variance.
  const double turned2 = across / (pooled.n * along);
  feigned_.push_back(
      information_along > 0 ? 0.0F : static_cast<float>(information_across * turned2 / (1 + turned2)));
}

}  // namespace slam::scanmatch
