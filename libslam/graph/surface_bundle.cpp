#include "libslam/graph/surface_bundle.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"
#include "libslam/tracking/step_variance.h"

namespace slam::graph {
namespace {

using Eigen::Matrix3d;

/// Fewer points do not tell which way a wall runs.
constexpr double kLeastPoints = 3;
/// Standard deviations beyond which a keyframe's points hardly count: half of what tracking allows, as poses
/// are known by now.
constexpr double kBundleKernel = keyframes::kKernel / 2;

float toFloat(double value) {
  return static_cast<float>(value);
}

}  // namespace

/// Of a keyframe's points in a cell those in a row that are seen from one side: sums from the cell's centre,
/// as scanmatch::ScanInCells has them.
struct SurfaceBundle::InCell {
  std::int32_t row, column, keyframe;
  float n, x, y, xx, xy, yy, nx, ny;
};

/// Where points lie, as they were seen from one side; from the centre of a cell.
struct SurfaceBundle::Spread {
  double n = 0;
  core::Point2 mean;
  core::Point2 direction;  ///< of most spread
  double along = 0, across = 0;
  bool isFlat() const { return across < scanmatch::kFlat * along; }
};

std::pair<std::int32_t, std::int32_t> SurfaceBundle::cellOf(const InCell& one) {
  return {one.row, one.column};
}

SurfaceBundle::SurfaceBundle(const keyframes::KeyframeMap& map)
    : map_(map),
      cell_m_(map.options().cell_m),
      blur2_(map.options().blur_m * map.options().blur_m),
      point_variance_(map.pointNoise().variance()) {
  collectSurfaces();
  collectTies();
  std::set<int> components;
  for (int k = 0; k < map.size(); ++k)
    if (components.insert(map.componentOf(k)).second) held_.push_back(k);
}

void SurfaceBundle::collectSurfaces() {
  Linked linked(static_cast<std::size_t>(map_.size()));
  std::vector<InCell> all;
  scanmatch::ScanInCells scan;
  for (int k = 0; k < map_.size(); ++k) {
    if (!map_.mayBeMatchedTo(k)) continue;
    auto& near = linked[static_cast<std::size_t>(k)];
    const double path_m = map_.options().map_path_m;
    near = map_.keyframesAround(k, core::position(map_.pose(k)), path_m, path_m);
    std::sort(near.begin(), near.end());
    scan.sort(map_.keyframe(k).points, map_.pose(k), cell_m_);
    for (const auto& [column, row, s] : scan.runs())
      all.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(column), k, toFloat(s.n),
                     toFloat(s.x), toFloat(s.y), toFloat(s.xx), toFloat(s.xy), toFloat(s.yy), toFloat(s.nx),
                     toFloat(s.ny)});
  }
  sortByCell(all);
  gatherWalls(all);
  sortByCell(all);
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    while (end < all.size() && cellOf(all[end]) == cellOf(all[begin])) ++end;
    addCell(all, begin, end, linked);
  }
}

void SurfaceBundle::sortByCell(std::vector<InCell>& all) {
  std::stable_sort(all.begin(), all.end(),
                   [](const InCell& a, const InCell& b) { return cellOf(a) < cellOf(b); });
}

/// Noise spreads a wall's points over two cells or more, across it: all go to the one that the middle of the
/// wall is in. Each cell by itself would have the points whose noise has put them there.
void SurfaceBundle::gatherWalls(std::vector<InCell>& all) const {
  const std::vector<InCell> before = all;
  Group around;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (i == 0 || cellOf(before[i]) != cellOf(before[i - 1])) around = neighbourhood(before, before[i]);
    const Spread spread = spreadOf(around, before[i]);
    if (!spread.isFlat()) continue;
    const double across_m = spread.direction.x * spread.mean.y - spread.direction.y * spread.mean.x;
    const auto cells = [&](double m) { return static_cast<std::int32_t>(std::lround(m / cell_m_)); };
    const std::int32_t columns = cells(-spread.direction.y * across_m),
                       rows = cells(spread.direction.x * across_m);
    InCell& one = all[i];
    scanmatch::ScanInCells::Sums moved;
    moved.add({one.n, one.x, one.y, one.xx, one.xy, one.yy, one.nx, one.ny}, 1, -columns * cell_m_,
              -rows * cell_m_);
    one.x = toFloat(moved.x), one.y = toFloat(moved.y);
    one.xx = toFloat(moved.xx), one.xy = toFloat(moved.xy), one.yy = toFloat(moved.yy);
    one.column += columns, one.row += rows;
  }
}

/// Apart by the side that points are seen from, and by what keyframes hang together.
void SurfaceBundle::addCell(const std::vector<InCell>& all, std::size_t begin, std::size_t end,
                            const Linked& linked) {
  std::vector<Group> groups;
  for (std::size_t i = begin; i < end; ++i) {
    const InCell& one = all[i];
    const auto& near = linked[static_cast<std::size_t>(one.keyframe)];
    const auto isOf = [&](const Group& group) {
      if (group.front()->nx * one.nx + group.front()->ny * one.ny < 0) return false;
      return std::any_of(group.rbegin(), group.rend(), [&](const InCell* other) {
        return other->keyframe == one.keyframe ||
               std::binary_search(near.begin(), near.end(), other->keyframe);
      });
    };
    Group joined;
    for (Group& group : groups) {
      if (!isOf(group)) continue;
      joined.insert(joined.end(), group.begin(), group.end());
      group.clear();
    }
    joined.push_back(&one);
    groups.erase(std::remove_if(groups.begin(), groups.end(), [](const Group& g) { return g.empty(); }),
                 groups.end());
    groups.push_back(std::move(joined));
  }
  const std::vector<const InCell*> around = neighbourhood(all, all[begin]);
  for (const Group& group : groups) addSurfaces(group, around);
}

/// What lies in a cell and in the eight beside it.
SurfaceBundle::Group SurfaceBundle::neighbourhood(const std::vector<InCell>& all, const InCell& one) {
  Group around;
  for (std::int32_t row = one.row - 1; row <= one.row + 1; ++row) {
    const std::pair first(row, one.column - 1), last(row, one.column + 1);
    auto next = std::lower_bound(all.begin(), all.end(), first,
                                 [](const InCell& a, const auto& cell) { return cellOf(a) < cell; });
    for (; next != all.end() && cellOf(*next) <= last; ++next) around.push_back(&*next);
  }
  return around;
}

/// Of those that are seen from the side that `first` is seen from.
SurfaceBundle::Spread SurfaceBundle::spreadOf(const Group& group, const InCell& first) const {
  scanmatch::ScanInCells::Sums sums;
  for (const InCell* s : group) {
    if (s->nx * first.nx + s->ny * first.ny < 0) continue;
    sums.add({s->n, s->x, s->y, s->xx, s->xy, s->yy, s->nx, s->ny}, 1, (s->column - first.column) * cell_m_,
             (s->row - first.row) * cell_m_);
  }
  const scanmatch::Spread spread = sums.spread();
  // At half the angle of (half, xy).
  const auto [sine, cosine] = core::sinCos(0.5 * core::atan2(spread.xy, spread.half));
  return {sums.n, {spread.mx, spread.my}, {cosine, sine}, spread.along, spread.across};
}

/// A cell alone is too small to tell which way a wall runs through it: what is around it tells that. A wall
/// says nothing of where along it one stands; anything else is where its points are.
void SurfaceBundle::addSurfaces(const Group& group, const Group& around) {
  const InCell& first = *group.front();
  const bool is_shared = std::any_of(group.begin(), group.end(),
                                     [&](const InCell* one) { return one->keyframe != first.keyframe; });
  if (!is_shared) return;
  const Spread wide = spreadOf(around, first);
  const bool is_wall = wide.isFlat();
  const Spread spread = is_wall ? wide : spreadOf(group, first);
  if (spread.n < kLeastPoints) return;
  const auto& [x, y] = spread.direction;
  addSurface(group, {x, y}, spread.mean, spread.across + blur2_);
  if (!is_wall && !spread.isFlat()) addSurface(group, {-y, x}, spread.mean, spread.along + blur2_);
}

/// How far each one's points lie off the line that all have in common, across `direction`, about `mean` and
/// with this variance.
void SurfaceBundle::addSurface(const Group& group, const core::Point2& direction, const core::Point2& mean,
                               double variance) {
  const auto& [ax, ay] = direction;
  const core::Point2 centre{(group.front()->column + 0.5) * cell_m_, (group.front()->row + 0.5) * cell_m_};
  Surface surface{seen_.size(), seen_.size() + group.size(), 0, 0};
  double middle_m = 0;
  for (const InCell* s : group) {
    const double x = s->x / s->n, y = s->y / s->n, off_m = ax * (y - mean.y) - ay * (x - mean.x);
    const double hold = 1 / (1 + off_m * off_m / (variance * kBundleKernel * kBundleKernel));
    const double points_err = map_.keyframe(s->keyframe).inherited.points_err;
    const double weight = s->n * hold * hold / (variance * point_variance_ * points_err * points_err);
    const double xx = s->xx / s->n - x * x, xy = s->xy / s->n - x * y, yy = s->yy / s->n - y * y;
    const double spread2 = std::max(ax * ax * xx + 2 * ax * ay * xy + ay * ay * yy, 0.0),
                 rise = ax * ay * (yy - xx) + (ax * ax - ay * ay) * xy;
    const core::Pose2& T = map_.pose(s->keyframe);
    Seen seen{s->keyframe, toFloat(-ay), toFloat(ax)};
    seen.phi = toFloat(ax * (centre.x + x - T.x) + ay * (centre.y + y - T.y));
    seen.weight = toFloat(weight);
    seen.along_m = toFloat(ax * (x - mean.x) + ay * (y - mean.y)), seen.spread2 = toFloat(spread2);
    seen.off_m = toFloat(off_m), seen.slope = toFloat(spread2 > 0 ? rise / spread2 : 0);
    surface.weight += seen.weight, middle_m += static_cast<double>(seen.weight) * seen.along_m;
    seen_.push_back(seen);
  }
  for (std::size_t i = surface.begin; i < surface.end; ++i) {
    Seen& seen = seen_[i];
    seen.along_m -= toFloat(middle_m / surface.weight);
    surface.lever += static_cast<double>(seen.weight) * (seen.along_m * seen.along_m + seen.spread2);
  }
  const Line common = lineOf(surface, [](const Seen& seen) { return Line{seen.off_m, seen.slope}; });
  for (std::size_t i = surface.begin; i < surface.end; ++i) {
    Seen& seen = seen_[i];
    seen.off_m -= toFloat(common.off_m + common.slope * seen.along_m);
    seen.slope -= toFloat(common.slope);
    chi2_ +=
        static_cast<double>(seen.weight) * (seen.off_m * seen.off_m + seen.spread2 * seen.slope * seen.slope);
  }
  surfaces_.push_back(surface);
}

void SurfaceBundle::collectTies() {
  const auto& edges = map_.graph().edges();
  std::vector<char> is_odometry(edges.size(), 0);
  by_odometry_.assign(static_cast<std::size_t>(map_.size()), Matrix3d::Zero());
  for (int k = 1; k < map_.size(); ++k) {
    const auto edge = static_cast<std::size_t>(map_.keyframe(k).odometry_edge);
    is_odometry[edge] = 1;
    addTie(edges[edge], 1, true);
    by_odometry_[static_cast<std::size_t>(k)] =
        scanmatch::turned(edges[edge].information, -map_.pose(k).phi) /
        (scanmatch::kInformationScale * point_variance_);
  }
  weighOdometry();
  for (const auto& loop : map_.loopEdges()) addTie(edges[loop.edge], loop.share, true);
  for (std::size_t i = 0; i < edges.size(); ++i)
    if (edges[i].on && !is_odometry[i] && edges[i].kind == posegraph::EdgeKind::kOdometry)
      addTie(edges[i], 1 / point_variance_, false);
  for (const Tie& tie : ties_)
    if (tie.is_measured) chi2_ += tie.off.dot(tie.information * tie.off);
}

/// Between parts that have no known place in one another nothing is measured.
void SurfaceBundle::addTie(const posegraph::Edge& edge, double share, bool is_measured) {
  if (map_.componentOf(edge.from) != map_.componentOf(edge.to)) return;
  const core::Pose2 &T_from = map_.pose(edge.from), &T = map_.pose(edge.to),
                    expected = T_from * edge.T_from_to;
  ties_.push_back({edge.from,
                   edge.to,
                   keyframes::moved(core::position(T_from), core::position(T)),
                   share * scanmatch::turned(edge.information, -T.phi),
                   {T.x - expected.x, T.y - expected.y, core::angleDifference(T.phi, expected.phi)},
                   is_measured});
}

/// Where surfaces hold a step's end, its error shows: odometry counts as it errs, and not as was assumed.
void SurfaceBundle::weighOdometry() {
  const auto told = toldBySurfaces();
  tracking::StepVariance variance;
  for (const Tie& tie : ties_) {
    const Matrix3d& of_end = told[static_cast<std::size_t>(tie.to)];
    variance.add(tie.off, scanmatch::covarianceOf(of_end + tie.information) * of_end,
                 scanmatch::covarianceOf(tie.information), Matrix3d::Zero(), Matrix3d::Zero());
  }
  for (Tie& tie : ties_)
    tie.information = scanmatch::covarianceOf(variance.of(scanmatch::covarianceOf(tie.information)));
}

}  // namespace slam::graph
