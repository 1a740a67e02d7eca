#include "libslam/scanmatch/field_matcher.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "libslam/core/elementary.h"
#include "libslam/core/rigid_motion2.h"

namespace slam::scanmatch {
namespace {

using gridmap::FieldCell;

/// Such points are corners, or walls whose noise hides their direction. The nearest surface is where the scan
/// before saw it: at full weight they hold every scan back along a corridor, by 2 % of the way on ring B.
constexpr double kWithoutNormal = 0.1;
/// Of the weights of the four cells around a point, what those make up that know its own face of the wall.
constexpr double kLeastOwn = 0.25;

/// The field at a point, in cells.
struct FieldVector {
  double x = 0, y = 0;
  double squared = 0;  ///< distance to the surface, and what the four vectors disagree by
};

/// Whether the surface near a cell is the other face of a wall than the one with this normal.
bool isOtherFace(const FieldCell& cell, double nx, double ny) {
  return gridmap::cosine(cell.side(), nx, ny) < gridmap::kOtherSide;
}

/// u, v: the point in units of cells; nx, ny: its normal, or (0, 0). False where no surface is within reach
/// of all four cells around it, or most of them know the other face of a wall.
bool fieldAt(const gridmap::Grid& grid, double u, double v, double nx, double ny, FieldVector& field) {
  const double x = std::floor(u - 0.5), y = std::floor(v - 0.5);
  std::array<const FieldCell*, 4> cells;
  if (!grid.square(static_cast<int>(x), static_cast<int>(y), cells)) return false;
  if (!cells[0]->nearSurface() || !cells[1]->nearSurface() || !cells[2]->nearSurface() ||
      !cells[3]->nearSurface())
    return false;
  const double a = u - 0.5 - x, b = v - 0.5 - y;
  std::array<double, 4> weight = {(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b};
  double share = 1, off_x = 0, off_y = 0;  // of the cells that count, and their middle from the point
  if (std::any_of(cells.begin(), cells.end(), [&](const auto* cell) { return isOtherFace(*cell, nx, ny); })) {
    for (size_t k = 0; k < 4; ++k)
      if (isOtherFace(*cells[k], nx, ny)) weight[k] = 0;
    share = weight[0] + weight[1] + weight[2] + weight[3];
    if (share < kLeastOwn) return false;
    off_x = (weight[1] + weight[3]) / share - a, off_y = (weight[2] + weight[3]) / share - b;
  }
  double sx = 0, sy = 0, squares = 0;
  for (size_t k = 0; k < 4; ++k) {
    const double fx = cells[k]->shift_x, fy = cells[k]->shift_y;
    sx += weight[k] * fx, sy += weight[k] * fy, squares += weight[k] * (fx * fx + fy * fy);
  }
  const double unit = 1 / (FieldCell::kShiftsPerCell * share);
  const double from_middle_x = sx * unit, from_middle_y = sy * unit;
  const double length2 = from_middle_x * from_middle_x + from_middle_y * from_middle_y;
  field.x = off_x + from_middle_x, field.y = off_y + from_middle_y;
  // Between two surfaces the vectors cancel. About one wall they disagree by half a cell at most in each
  // direction.
  field.squared =
      field.x * field.x + field.y * field.y + std::max(0.0, squares * unit * unit * share - length2 - 0.5);
  return true;
}

/// Square of the distance that a point's robust weight comes from, in cells. Along its own surface (unit
/// normal nx, ny) a tenth counts: where beams meet a wall far apart, the nearest return of the map is
/// elsewhere on the same wall.
double squaredError(const FieldVector& field, double nx, double ny) {
  if (nx == 0 && ny == 0) return field.squared;
  constexpr double kAlong = 0.1;
  const double along = nx * field.y - ny * field.x;
  return field.squared - (1 - kAlong) * along * along;
}

struct System {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double weight_sum = 0, weighted_squares = 0;
  double robust_sum = 0;  ///< of the kernel's squared errors, square metres
};

System accumulate(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid, const core::Pose2& T,
                  double kernel_m) {
  const auto [s, c] = core::sinCos(T.phi);
  const double cell = grid.cellSize(), per_cell = 1 / cell;
  const double kernel2 = kernel_m * kernel_m;
  double hxx = 0, hxy = 0, hyy = 0, hxt = 0, hyt = 0, htt = 0, gx = 0, gy = 0, gt = 0, weights = 0,
         squares = 0, robust = 0;
  for (const SurfacePoint& point : points) {
    const double rx = c * point.p.x - s * point.p.y, ry = s * point.p.x + c * point.p.y;
    const double nx = c * point.n.x - s * point.n.y, ny = s * point.n.x + c * point.n.y;
    FieldVector field;
    if (!fieldAt(grid, (T.x + rx) * per_cell, (T.y + ry) * per_cell, nx, ny, field)) {
      robust += kernel2;
      continue;
    }
    const double squared = squaredError(field, nx, ny) * cell * cell;
    const double root = kernel2 / (kernel2 + squared);
    double w = root * root;
    weights += w, squares += w * squared, robust += squared * root;
    const double vx = field.x * cell, vy = field.y * cell;
    if (point.n.x == 0 && point.n.y == 0) {
      w *= kWithoutNormal;
      hxx += w, hyy += w, hxt -= w * ry, hyt += w * rx, htt += w * (rx * rx + ry * ry);
      gx -= w * vx, gy -= w * vy, gt -= w * (rx * vy - ry * vx);
      continue;
    }
    const double nt = rx * ny - ry * nx, e = w * (nx * vx + ny * vy);
    hxx += w * nx * nx, hxy += w * nx * ny, hyy += w * ny * ny;
    hxt += w * nx * nt, hyt += w * ny * nt, htt += w * nt * nt;
    gx -= nx * e, gy -= ny * e, gt -= nt * e;
  }
  System system;
  system.H << hxx, hxy, hxt, hxy, hyy, hyt, hxt, hyt, htt;
  system.g << gx, gy, gt;
  system.weight_sum = weights, system.weighted_squares = squares, system.robust_sum = robust;
  return system;
}

Eigen::Vector3d offPrior(const core::Pose2& T, const PosePrior& prior) {
  return {T.x - prior.mean.x, T.y - prior.mean.y, core::angleDifference(T.phi, prior.mean.phi)};
}

/// The position's information with the heading left free, and its weaker direction.
void findFreeDirection(double degenerate_m, FieldMatch& match) {
  const Eigen::Matrix3d& H = match.information;
  const double turn = H(2, 2) > 0 ? 1 / H(2, 2) : 0;
  const double xx = H(0, 0) - H(0, 2) * H(0, 2) * turn, yy = H(1, 1) - H(1, 2) * H(1, 2) * turn;
  const double xy = H(0, 1) - H(0, 2) * H(1, 2) * turn;
  const double half = (xx - yy) / 2, root = std::sqrt(half * half + xy * xy);
  const double weak = std::max((xx + yy) / 2 - root, 1e-12), strong = std::max((xx + yy) / 2 + root, 1e-12);
  // (xx - strong, xy) and (xy, yy - strong) are both along it; the longer one is the better conditioned.
  core::Point2 along = half <= 0 ? core::Point2{half - root, xy} : core::Point2{xy, -half - root};
  const double length = std::sqrt(along.x * along.x + along.y * along.y);
  match.free_direction = length > 0 ? core::Point2{along.x / length, along.y / length} : core::Point2{1, 0};
  match.free_sigma_m = 1 / std::sqrt(weak), match.fixed_sigma_m = 1 / std::sqrt(strong);
  match.degenerate = match.free_sigma_m > degenerate_m;
}

/// A beam goes through a wall where it comes to it and leaves it over clear ground, so far on either side;
/// one along a wall may touch it.
constexpr double kClear_m = 0.3;

std::optional<gridmap::Cell> cellAt(const gridmap::Grid& grid, const core::Point2& p) {
  const double per_cell = 1 / grid.cellSize();
  return grid.at(static_cast<int>(std::floor(p.x * per_cell)), static_cast<int>(std::floor(p.y * per_cell)));
}

/// Whether the straight line to a point leads through a surface long before its end.
bool goesThroughWall(const gridmap::Grid& grid, const core::Point2& from, const core::Point2& to) {
  const double length_m = core::distance(from, to), step_m = grid.cellSize();
  const auto at = [&](double along_m) {
    const double share = along_m / length_m;
    return core::Point2{from.x + share * (to.x - from.x), from.y + share * (to.y - from.y)};
  };
  const auto isClear = [&](double along_m) {
    const auto cell = cellAt(grid, at(along_m));
    if (!cell || !cell->nearSurface()) return true;
    const double cells = core::hypot(cell->toX(), cell->toY());
    return cells * step_m > kClear_m / 2;
  };
  for (double along_m = kClear_m; along_m + kClear_m < length_m; along_m += step_m) {
    const auto cell = cellAt(grid, at(along_m));
    if (cell && cell->occupied() && isClear(along_m - kClear_m) && isClear(along_m + kClear_m)) return true;
  }
  return false;
}

}  // namespace

FieldMatch alignToField(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid,
                        const core::Pose2& T_start, const PosePrior& prior,
                        const FieldMatchOptions& options) {
  FieldMatch match;
  match.T_map_robot = T_start;
  const double scale = options.information_scale / (options.sigma_m * options.sigma_m);
  for (;;) {
    core::Pose2& T = match.T_map_robot;
    const System system = accumulate(points, grid, T, options.kernel_m);
    const Eigen::Vector3d off = offPrior(T, prior);
    match.information = scale * system.H;
    match.cost = 0.5 * scale * system.robust_sum;
    match.prior_cost = 0.5 * off.dot(prior.information * off);
    match.score = points.empty() ? 0 : system.weight_sum / static_cast<double>(points.size());
    match.residual_m = system.weight_sum > 0 ? std::sqrt(system.weighted_squares / system.weight_sum) : 0;
    if (match.iterations == options.max_iterations) break;
    ++match.iterations;
    const Eigen::Matrix3d H = match.information + prior.information + 1e-6 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = H.ldlt().solve(-scale * system.g - prior.information * off);
    if (!step.allFinite()) break;
    // A surface that pulls from the edge of the field must not throw the scan farther than the field reaches.
    const double reach_m = grid.options().reach_cells * grid.cellSize();
    const double shorten = std::min(
        {1.0, reach_m / std::max(step.head<2>().norm(), 1e-12), 0.3 / std::max(std::abs(step.z()), 1e-12)});
    T = {T.x + shorten * step.x(), T.y + shorten * step.y(), core::wrapToPi(T.phi + shorten * step.z())};
    if (step.head<2>().squaredNorm() < 1e-8 && std::abs(step.z()) < 3e-5) break;
  }
  findFreeDirection(options.degenerate_m, match);
  return match;
}

double fieldScore(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid,
                  const core::Pose2& T_map_robot, double kernel_m, int stride) {
  const auto [s, c] = core::sinCos(T_map_robot.phi);
  const double per_cell = 1 / grid.cellSize();
  const double kernel2 = kernel_m * kernel_m * per_cell * per_cell;
  double sum = 0;
  int count = 0;
  for (size_t i = 0; i < points.size(); i += static_cast<size_t>(stride)) {
    ++count;
    const core::Point2 &p = points[i].p, &n = points[i].n;
    const double nx = c * n.x - s * n.y, ny = s * n.x + c * n.y;
    FieldVector field;
    if (!fieldAt(grid, (T_map_robot.x + c * p.x - s * p.y) * per_cell,
                 (T_map_robot.y + s * p.x + c * p.y) * per_cell, nx, ny, field))
      continue;
    const double root = kernel2 / (kernel2 + squaredError(field, nx, ny));
    sum += root * root;
  }
  return count ? sum / count : 0;
}

double fieldTold(const std::vector<SurfacePoint>& points, const gridmap::Grid& grid,
                 const core::Pose2& T_map_robot, int stride) {
  const core::RigidMotion2 T(T_map_robot);
  const auto [s, c] = core::sinCos(T_map_robot.phi);
  const core::Point2 robot = core::position(T_map_robot);
  int told = 0, count = 0;
  for (size_t i = 0; i < points.size(); i += static_cast<size_t>(stride)) {
    ++count;
    const core::Point2 p = T * points[i].p;
    const auto cell = cellAt(grid, p);
    const core::Point2& n = points[i].n;
    const bool is_near =
        cell && cell->nearSurface() && !isOtherFace(*cell, c * n.x - s * n.y, s * n.x + c * n.y);
    told += is_near || (cell && cell->seen()) || goesThroughWall(grid, robot, p);
  }
  return count ? static_cast<double>(told) / count : 0;
}

}  // namespace slam::scanmatch
