#include "libslam/scanmatch/surfel_map.h"

#include <algorithm>
#include <cmath>

namespace slam::scanmatch {
namespace {

/// A neighbourhood this flat (variance across to along) is a wall.
constexpr double kFlat = 0.15;
/// On the mixed term: more than what rounding to float may take off the determinant, so that a surfel's information is
/// positive semidefinite as it is stored.
constexpr double kHeldBack = 1 - 2.5e-7;

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
  sums_.clear(), cells_.clear(), surfels_.clear(), asked_cells_.clear();
}

void SurfelMap::add(const std::vector<PatchPoint>& points, const core::Pose2& T_map_robot) {
  const double c = std::cos(T_map_robot.phi), s = std::sin(T_map_robot.phi);
  const double tx = T_map_robot.x - origin_.x, ty = T_map_robot.y - origin_.y;
  for (const auto& point : points) {
    const double x = tx + c * point.x - s * point.y, y = ty + s * point.x + c * point.y;
    const auto column = static_cast<std::int64_t>(std::floor(x * per_cell_));
    const auto row = static_cast<std::int64_t>(std::floor(y * per_cell_));
    // The rim stays empty so that neighbours need no check.
    if (column < 2 || row < 2 || column >= side_ - 2 || row >= side_ - 2) continue;
    const std::int64_t cell = row * side_ + column;
    std::int32_t& index = sums_of_[static_cast<size_t>(cell)];
    if (index < 0) {
      index = static_cast<std::int32_t>(sums_.size());
      sums_.emplace_back();
      cells_.push_back(cell);
    }
    const double dx = x - (static_cast<double>(column) + 0.5) * cell_m_;
    const double dy = y - (static_cast<double>(row) + 0.5) * cell_m_;
    Sums& sums = sums_[static_cast<size_t>(index)];
    const double ax = c * point.along_x - s * point.along_y, ay = s * point.along_x + c * point.along_y;
    sums.n += 1, sums.x += dx, sums.y += dy;
    sums.xx += dx * dx + ax * ax, sums.xy += dx * dy + ax * ay, sums.yy += dy * dy + ay * ay;
  }
}

std::int32_t SurfelMap::makeSurfel(std::int64_t cell) const {
  std::int32_t& index = surfel_of_[static_cast<size_t>(cell)];
  asked_cells_.push_back(cell);
  index = kNone;
  // The rim is empty, and its cells have no neighbours to ask.
  const std::int64_t column = cell % side_, row = cell / side_;
  if (column < 1 || row < 1 || column >= side_ - 1 || row >= side_ - 1) return index;
  Sums pooled;
  for (int r = -1; r <= 1; ++r)
    for (int k = -1; k <= 1; ++k) {
      const std::int32_t at = sums_of_[static_cast<size_t>(cell + r * side_ + k)];
      if (at < 0) continue;
      const Sums& sums = sums_[static_cast<size_t>(at)];
      const double w = (r == 0 ? 1.0 : 0.5) * (k == 0 ? 1.0 : 0.5);
      const double ox = k * cell_m_, oy = r * cell_m_;
      pooled.n += w * sums.n;
      pooled.x += w * (sums.x + sums.n * ox), pooled.y += w * (sums.y + sums.n * oy);
      pooled.xx += w * (sums.xx + 2 * ox * sums.x + sums.n * ox * ox);
      pooled.xy += w * (sums.xy + ox * sums.y + oy * sums.x + sums.n * ox * oy);
      pooled.yy += w * (sums.yy + 2 * oy * sums.y + sums.n * oy * oy);
    }
  if (pooled.n < 2) return index;
  const double mx = pooled.x / pooled.n, my = pooled.y / pooled.n;
  const double xx = pooled.xx / pooled.n - mx * mx, yy = pooled.yy / pooled.n - my * my;
  const double xy = pooled.xy / pooled.n - mx * my;
  const double half = (xx - yy) / 2, root = std::sqrt(half * half + xy * xy);
  const double along = (xx + yy) / 2 + root, across = std::max((xx + yy) / 2 - root, 0.0);
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
  index = static_cast<std::int32_t>(surfels_.size());
  surfels_.push_back({static_cast<float>(cx + mx), static_cast<float>(cy + my),
                      static_cast<float>(information_across + gain * ux * ux),
                      static_cast<float>(kHeldBack * gain * ux * uy),
                      static_cast<float>(information_across + gain * uy * uy)});
  return index;
}

}  // namespace slam::scanmatch
