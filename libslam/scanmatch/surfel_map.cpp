#include "libslam/scanmatch/surfel_map.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::scanmatch {
namespace {

/// Two faces of a wall have so many points each, at least, and their means are so many times as far apart,
/// squared, as means of so many points err.
constexpr double kLeastOfFace = 3, kApart2 = 9;
/// Fewer points, each by its weight, say little of which way a wall runs: then a wider neighbourhood is
/// pooled, evenly, if it is flat. With 5 to 12 here maps of sparse scans are about as good.
constexpr double kFewPoints = 6;
constexpr int kNear = 1, kWide = 2;
/// In a map of one scan a wide surfel is no surer than its points, and explains wrong places, too.
constexpr int kLeastScans = 2;
/// Variances, m^2, that differ by less are the same: the inverse of this is a number still.
constexpr double kNoDirection = 1e-200;
/// On the mixed term: more than what rounding to float may take off the determinant, so that a surfel's
/// information is positive semidefinite as it is stored.
constexpr double kHeldBack = 1 - 2.5e-7;

/// Whether two directions are more than 120 degrees apart: normals of single points err much.
bool areOpposite(double ax, double ay, double bx, double by) {
  const double dot = ax * bx + ay * by;
  return dot < 0 && 4 * dot * dot > (ax * ax + ay * ay) * (bx * bx + by * by);
}

/// Column or row of a coordinate in the plane. std::floor() is a call.
std::int64_t cellOfPlane(double at_m, double per_cell) {
  const double at = at_m * per_cell;
  const auto cell = static_cast<std::int64_t>(at);
  return cell - (at < static_cast<double>(cell) ? 1 : 0);
}

}  // namespace

void ScanInCells::sort(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot, double cell_m) {
  runs_.clear();
  const auto [s, c] = core::sinCos(T_map_robot.phi);
  const double per_cell = 1 / cell_m;
  for (const auto& point : points) {
    const double x = T_map_robot.x + c * point.x - s * point.y, y = T_map_robot.y + s * point.x + c * point.y;
    const auto column = cellOfPlane(x, per_cell), row = cellOfPlane(y, per_cell);
    const double dx = x - (static_cast<double>(column) + 0.5) * cell_m,
                 dy = y - (static_cast<double>(row) + 0.5) * cell_m;
    // With the lidar on the left.
    const double ax = c * point.along_x - s * point.along_y, ay = s * point.along_x + c * point.along_y;
    const double length2 = ax * ax + ay * ay, inverse = length2 > 0 ? 1 / std::sqrt(length2) : 0;
    const double nx = -ay * inverse, ny = ax * inverse;
    if (runs_.empty() || runs_.back().column != column || runs_.back().row != row ||
        areOpposite(runs_.back().sums.nx, runs_.back().sums.ny, nx, ny))
      runs_.push_back({column, row, {}});
    Sums& sums = runs_.back().sums;
    sums.n += 1, sums.x += dx, sums.y += dy;
    sums.xx += dx * dx + ax * ax, sums.xy += dx * dy + ax * ay, sums.yy += dy * dy + ay * ay;
    sums.nx += nx, sums.ny += ny;
  }
}

void SurfelMap::clear(const core::Point2& centre, double reach_m) {
  const auto side = static_cast<std::int64_t>(std::ceil(2 * reach_m / cell_m_)) + 6;
  if (side != side_) {
    side_ = side;
    sums_of_.assign(static_cast<size_t>(side * side), -1);
    surfel_of_.assign(static_cast<size_t>(side * side), kUnknown);
  } else {
    for (const Cell& cell : cells_) sums_of_[static_cast<size_t>(at(cell))] = -1;
    for (const auto cell : asked_cells_) surfel_of_[static_cast<size_t>(cell)] = kUnknown;
  }
  per_cell_ = 1 / cell_m_;
  extent_m_ = (static_cast<double>(side_) - 0.5) * cell_m_;
  first_column_ = cellOfPlane(centre.x - reach_m, per_cell_) - 3;
  first_row_ = cellOfPlane(centre.y - reach_m, per_cell_) - 3;
  origin_ = {static_cast<double>(first_column_) * cell_m_, static_cast<double>(first_row_) * cell_m_};
  sums_.clear(), cells_.clear(), surfels_.clear(), first_views_.clear(), feigned_.clear(),
      asked_cells_.clear();
  scans_ = 0;
}

void SurfelMap::add(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot, int view) {
  scan_.sort(points, T_map_robot, cell_m_);
  add(scan_, view);
}

void SurfelMap::add(const ScanInCells& scan, int view) {
  ++scans_;
  for (const auto& [column, row, seen] : scan.runs_) {
    const std::int32_t index = indexOf(column - first_column_, row - first_row_);
    if (index < 0) continue;
    Sums& sums = two_sided_ ? faceOf(index, seen) : sums_[static_cast<size_t>(index)];
    sums.first_view = std::min(sums.first_view, view);
    sums.n += seen.n, sums.x += seen.x, sums.y += seen.y;
    sums.xx += seen.xx, sums.xy += seen.xy, sums.yy += seen.yy;
    if (two_sided_) sums.nx += seen.nx, sums.ny += seen.ny;
  }
}

void SurfelMap::add(const SurfelMap& finer) {
  scans_ += finer.scans_;
  const auto ratio = static_cast<std::int64_t>(cell_m_ / finer.cell_m_ + 0.5);
  const double middle = (static_cast<double>(ratio) - 1) / 2;
  for (const Cell& cell : finer.cells_) {
    const std::int64_t its_column = cell.column + finer.first_column_, its_row = cell.row + finer.first_row_;
    const std::int64_t column = its_column >= 0 ? its_column / ratio : -((ratio - 1 - its_column) / ratio),
                       row = its_row >= 0 ? its_row / ratio : -((ratio - 1 - its_row) / ratio);
    const std::int32_t index = indexOf(column - first_column_, row - first_row_);
    if (index < 0) continue;
    const double ox = (static_cast<double>(its_column - column * ratio) - middle) * finer.cell_m_,
                 oy = (static_cast<double>(its_row - row * ratio) - middle) * finer.cell_m_;
    Sums& own = sums_[static_cast<size_t>(index)];
    for (std::int32_t face = finer.sums_of_[static_cast<size_t>(finer.at(cell))]; face >= 0;) {
      const Sums& sums = finer.sums_[static_cast<size_t>(face)];
      own.add(sums, 1, ox, oy);
      own.first_view = std::min(own.first_view, sums.first_view);
      face = sums.back;
    }
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
    cells_.push_back({static_cast<std::int32_t>(column), static_cast<std::int32_t>(row)});
  }
  return index;
}

/// The sums of a cell for points that were seen from one side.
SurfelMap::Sums& SurfelMap::faceOf(std::int32_t index, const ScanInCells::Sums& seen) {
  const auto face = static_cast<size_t>(index);
  if (!areOpposite(sums_[face].nx, sums_[face].ny, seen.nx, seen.ny)) return sums_[face];
  if (sums_[face].back < 0) {
    sums_[face].back = static_cast<std::int32_t>(sums_.size());
    sums_.emplace_back();
  }
  return sums_[static_cast<size_t>(sums_[face].back)];
}

/// Whether points seen from opposite sides lie apart, each on its own side: otherwise they are one thin or
/// rough thing.
bool SurfelMap::areTwoFaces(const Sums& front, const Sums& back) {
  if (front.n < kLeastOfFace || back.n < kLeastOfFace) return false;
  // From back to front, of any length: both sides of the comparison grow with its square.
  const double dx = front.nx / front.n - back.nx / back.n, dy = front.ny / front.n - back.ny / back.n;
  const double apart =
      dx * (front.x / front.n - back.x / back.n) + dy * (front.y / front.n - back.y / back.n);
  const auto errs2 = [&](const Sums& sums) {
    const double mx = sums.x / sums.n, my = sums.y / sums.n;
    return (dx * dx * (sums.xx / sums.n - mx * mx) + 2 * dx * dy * (sums.xy / sums.n - mx * my) +
            dy * dy * (sums.yy / sums.n - my * my)) /
           sums.n;
  };
  return apart > 0 && apart * apart > kApart2 * (errs2(front) + errs2(back));
}

/// Whether they lie along one wall, whichever side they were seen from.
bool SurfelMap::isFlat(const Faces& faces) {
  Sums all = faces.front;
  all.add(faces.back, 1, 0, 0);
  const Spread spread = all.spread();
  return spread.across < kFlat * spread.along;
}

/// The points of a cell's neighbourhood, `reach` cells to each side, from the centre of the cell; `faces` are
/// empty before. REQUIRES that it lies within the map.
void SurfelMap::pool(std::int64_t cell, int reach, Faces& faces) const {
  double nx = 0, ny = 0;  // of the front
  if (const std::int32_t own = sums_of_[static_cast<size_t>(cell)]; own >= 0)
    nx = sums_[static_cast<size_t>(own)].nx, ny = sums_[static_cast<size_t>(own)].ny;
  const double beside = reach == kNear ? 0.5 : 1;
  for (int r = -reach; r <= reach; ++r) {
    const std::int32_t* of_row = &sums_of_[static_cast<size_t>(cell + r * side_)];
    for (int k = -reach; k <= reach; ++k)
      for (std::int32_t face = of_row[k]; face >= 0;) {
        const Sums& sums = sums_[static_cast<size_t>(face)];
        if (nx == 0 && ny == 0) nx = sums.nx, ny = sums.ny;
        Sums& to = two_sided_ && areOpposite(nx, ny, sums.nx, sums.ny) ? faces.back : faces.front;
        to.add(sums, (r == 0 ? 1.0 : beside) * (k == 0 ? 1.0 : beside), k * cell_m_, r * cell_m_);
        to.first_view = std::min(to.first_view, sums.first_view);
        face = sums.back;
      }
  }
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
  Faces faces;
  auto& [front, back] = faces;
  pool(cell, kNear, faces);
  const double count = front.n + back.n;
  if (widens_ && scans_ >= kLeastScans && count > 0 && count < kFewPoints && isWithin(kWide)) {
    Faces wide;
    pool(cell, kWide, wide);
    if (isFlat(wide)) faces = wide;
  }
  if (front.n + back.n < 2) return index;
  index = static_cast<std::int32_t>(surfels_.size());
  const bool are_two = areTwoFaces(front, back);
  if (!are_two && back.n > 0)
    front.add(back, 1, 0, 0), front.first_view = std::min(front.first_view, back.first_view);
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
  // Of the unit vector along: squares of its parts and their product, that of the smaller one without a
  // difference. What a wall next to parallel to an axis tells along that axis would be lost otherwise, and
  // with it that the information is positive semidefinite.
  const double per_root = root > kNoDirection ? 0.5 / root : 0, product = xy * per_root,
               larger = 0.5 + (root > kNoDirection ? std::abs(half) * per_root : 0.5),
               smaller = product * product / larger;
  const double ux2 = half >= 0 ? larger : smaller, uy2 = half >= 0 ? smaller : larger;
  const double gain = information_along - information_across;
  const double cx = (static_cast<double>(column) + 0.5) * cell_m_;
  const double cy = (static_cast<double>(row) + 0.5) * cell_m_;
  surfels_.push_back({static_cast<float>(cx + mx), static_cast<float>(cy + my),
                      static_cast<float>(information_along * ux2 + information_across * uy2),
                      static_cast<float>(kHeldBack * gain * product),
                      static_cast<float>(information_along * uy2 + information_across * ux2),
                      static_cast<float>(pooled.nx / pooled.n), static_cast<float>(pooled.ny / pooled.n),
                      -1});
  first_views_.push_back(pooled.first_view);
  // The direction of a line through n points errs by the variance across / (n along): its square's share.
  feigned_.push_back(information_along > 0
                         ? 0.0F
                         : static_cast<float>(information_across * across / (pooled.n * along + across)));
}

}  // namespace slam::scanmatch
