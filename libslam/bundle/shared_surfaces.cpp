#include "libslam/bundle/shared_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/core/numbers.h"

namespace slam::bundle {
namespace {

/// Fewer points do not tell which way a wall runs.
constexpr double kLeastPoints = 3;
/// A wall is no wall whose points scatter so much more than those of half of all walls do.
constexpr double kThickest = 4;
constexpr int kInStretch = 8;
constexpr std::int64_t kRowsOfBand = 128;
/// What a band looks at on both sides: a wall's points move by up to four rows, by what lies two rows around
/// them, to where two rows around tell which way the wall runs.
constexpr std::int64_t kMargin = 8;

float toFloat(double value) {
  return static_cast<float>(value);
}

/// Where points are that are spread like this, and which way they run.
core::Point2 meanOf(const scanmatch::Spread& spread) {
  return {spread.mx, spread.my};
}

core::Point2 directionOf(const scanmatch::Spread& spread) {
  // At half the angle of (half, xy).
  const auto [sine, cosine] = core::sinCos(0.5 * core::atan2(spread.xy, spread.half));
  return {cosine, sine};
}

bool isFlat(const scanmatch::Spread& spread) {
  return spread.across < scanmatch::kFlat * spread.along;
}

}  // namespace

SharedSurfaces::SharedSurfaces(const keyframes::KeyframeMap& map)
    : map_(map),
      cell_m_(map.options().cell_m),
      blur2_(map.options().blur_m * map.options().blur_m),
      stretch_(static_cast<std::size_t>(map.size()), -1) {
  divideWay();
}

/// Keyframes that hang together by the way driven, and what hangs together with the last of them.
void SharedSurfaces::divideWay() {
  std::vector<int> last;
  int before = -1, count = 0;
  for (int k = 0; k < map_.size(); ++k) {
    if (!map_.mayBeMatchedTo(k)) continue;
    if (before < 0 || map_.keyframeBefore(k) != before || ++count >= kInStretch) last.push_back(k), count = 0;
    last.back() = before = k;
    stretch_[static_cast<std::size_t>(k)] = static_cast<int>(last.size()) - 1;
  }
  const double path_m = map_.options().map_path_m;
  for (const int k : last) {
    auto near = map_.keyframesAround(k, core::position(map_.pose(k)), path_m, path_m);
    for (int& other : near) other = stretch_[static_cast<std::size_t>(other)];
    std::sort(near.begin(), near.end());
    near.erase(std::unique(near.begin(), near.end()), near.end());
    linked_.emplace_back(near.begin(), near.end());
  }
}

bool SharedSurfaces::areLinked(int from, int to) const {
  const auto& near = linked_[static_cast<std::size_t>(from)];
  return from == to || std::binary_search(near.begin(), near.end(), to);
}

void SharedSurfaces::forEach(const Visit& visit) const {
  const auto of_keyframes = rowsOfKeyframes();
  constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  const auto nextWithPoints = [&](std::int64_t row) {
    std::int64_t next = kNone;
    for (const auto& [first, end] : of_keyframes)
      if (end > row) next = std::min(next, std::max(first, row));
    return next;
  };
  Groups groups;
  std::int64_t row = std::numeric_limits<std::int64_t>::min() + kMargin;
  for (; nextWithPoints(row - kMargin) != kNone; row += kRowsOfBand) {
    // Walls may be moved to rows before those of points.
    row = std::max(row, nextWithPoints(row - kMargin) - kMargin);
    PointsByCell points;
    collect({row - kMargin, row + kRowsOfBand + kMargin}, of_keyframes, points);
    points.sumUp();
    gatherWalls(points);
    points.sumUp();
    for (const auto& cell : points.cells())
      if (cell.row >= row && cell.row < row + kRowsOfBand) visitCell(points, cell, groups, visit);
  }
}

std::vector<SharedSurfaces::Rows> SharedSurfaces::rowsOfKeyframes() const {
  constexpr std::int64_t kNowhere = std::numeric_limits<std::int64_t>::min();
  std::vector<Rows> rows(static_cast<std::size_t>(map_.size()), Rows(kNowhere, kNowhere));
  for (int k = 0; k < map_.size(); ++k) {
    const auto& points = map_.keyframe(k).points;
    if (!map_.mayBeMatchedTo(k) || points.empty()) continue;
    const core::Pose2& T = map_.pose(k);
    const auto [s, c] = core::sinCos(T.phi);
    double least_m = core::kInfinity, most_m = -core::kInfinity;
    for (const auto& point : points) {
      const double y = T.y + s * point.x + c * point.y;
      least_m = std::min(least_m, y), most_m = std::max(most_m, y);
    }
    rows[static_cast<std::size_t>(k)] = {static_cast<std::int64_t>(std::floor(least_m / cell_m_)),
                                         static_cast<std::int64_t>(std::floor(most_m / cell_m_)) + 1};
  }
  return rows;
}

void SharedSurfaces::collect(const Rows& rows, const std::vector<Rows>& of_keyframes,
                             PointsByCell& points) const {
  scanmatch::ScanInCells scan;
  std::vector<scanmatch::PatchPoint> within;
  // A row more on each side: rounding decides at a border.
  const double least_m = static_cast<double>(rows.first - 1) * cell_m_,
               most_m = static_cast<double>(rows.second + 1) * cell_m_;
  for (int k = 0; k < map_.size(); ++k) {
    const auto& [first, end] = of_keyframes[static_cast<std::size_t>(k)];
    if (first >= rows.second || end <= rows.first) continue;
    const core::Pose2& T = map_.pose(k);
    const auto [sine, cosine] = core::sinCos(T.phi);
    within.clear();
    for (const auto& point : map_.keyframe(k).points)
      if (const double y = T.y + sine * point.x + cosine * point.y; y >= least_m && y <= most_m)
        within.push_back(point);
    scan.sort(within, T, cell_m_);
    for (const auto& [column, row, s] : scan.runs())
      if (row >= rows.first && row < rows.second)
        points.add({static_cast<std::int32_t>(row), static_cast<std::int32_t>(column), k, toFloat(s.n),
                    toFloat(s.x), toFloat(s.y), toFloat(s.xx), toFloat(s.xy), toFloat(s.yy), toFloat(s.nx),
                    toFloat(s.ny), 0, 0, 0});
  }
}

/// Noise spreads a wall's points over two cells or more, across it: all go to the one that the middle of the
/// wall is in. Each cell by itself would have the points whose noise has put them there. What looks like
/// clutter from nearby may be a wall seen with much noise: from farther off that shows, and it is believed if
/// the wall is not much thicker than others are here.
void SharedSurfaces::gatherWalls(PointsByCell& points) const {
  std::vector<double> thickness2;
  findWalls(points, 1, core::kInfinity, thickness2);
  if (!thickness2.empty()) {
    const auto middle = thickness2.begin() + static_cast<std::ptrdiff_t>(thickness2.size() / 2);
    std::nth_element(thickness2.begin(), middle, thickness2.end());
    const double most = kThickest * kThickest * *middle;
    findWalls(points, 2, most, thickness2);
  }
  for (PointsInCell& one : points.all()) {
    if (one.columns_off == 0 && one.rows_off == 0) continue;
    PointsByCell::Sums moved;
    moved.add(sumsOf(one), 1, -one.columns_off * cell_m_, -one.rows_off * cell_m_);
    one.x = toFloat(moved.x), one.y = toFloat(moved.y);
    one.xx = toFloat(moved.xx), one.xy = toFloat(moved.xy), one.yy = toFloat(moved.yy);
    one.column += one.columns_off, one.row += one.rows_off;
    one.columns_off = one.rows_off = 0;
  }
}

/// Walls of at most this variance across, of points that have none yet; the variances.
void SharedSurfaces::findWalls(PointsByCell& points, std::int8_t reach, double most,
                               std::vector<double>& thickness2) const {
  std::vector<Fan> without;  // points of the cell that are on no wall, as is what else lies on their side
  for (const auto& cell : points.cells()) {
    without.clear();
    for (std::size_t i = cell.begin; i < cell.end; ++i) {
      const PointsInCell& one = points.at(i);
      if (one.reach != 0) continue;
      const bool was_tried =
          std::any_of(without.begin(), without.end(), [&](const Fan& fan) { return fan.isAnyOnSideOf(one); });
      if (!was_tried && findWall(points, cell, i, reach, most, thickness2)) continue;
      const auto fan =
          std::find_if(without.begin(), without.end(), [&](const Fan& known) { return known.takes(one); });
      if (fan == without.end())
        without.emplace_back(one);
      else
        fan->add(one);
    }
  }
}

/// Of a cell's points from the i-th on, on its side: how far off the middle of their wall is.
bool SharedSurfaces::findWall(PointsByCell& points, const PointsByCell::Cell& cell, std::size_t i,
                              std::int8_t reach, double most, std::vector<double>& thickness2) const {
  const PointsInCell& first = points.at(i);
  const scanmatch::Spread spread = points.around(cell, reach, first, cell_m_).spread();
  if (!isFlat(spread) || spread.across > most) return false;
  const auto cells = [&](double m) { return static_cast<std::int8_t>(std::lround(m / cell_m_)); };
  const core::Point2 direction = directionOf(spread), mean = meanOf(spread);
  const double across_m = direction.x * mean.y - direction.y * mean.x;
  const std::int8_t columns = cells(-direction.y * across_m), rows = cells(direction.x * across_m);
  thickness2.push_back(spread.across);
  for (; i < cell.end; ++i) {
    PointsInCell& one = points.at(i);
    if (one.reach == 0 && areOnOneSide(first, one))
      one.reach = reach, one.columns_off = columns, one.rows_off = rows;
  }
  return true;
}

void SharedSurfaces::Group::add(const PointsInCell& one, int stretch) {
  points.push_back(&one);
  if (stretches.empty() || stretches.back() != stretch) stretches.push_back(stretch);
}

void SharedSurfaces::Group::takeOver(Group& other) {
  points.insert(points.end(), other.points.begin(), other.points.end());
  stretches.insert(stretches.end(), other.stretches.begin(), other.stretches.end());
  other.points.clear(), other.stretches.clear();
}

/// What it belongs to becomes one group, and the last.
void SharedSurfaces::join(const PointsInCell& one, Groups& groups) const {
  const int stretch = stretchOf(one);
  const auto isOf = [&](const Group& group) {
    if (!areOnOneSide(*group.points.front(), one)) return false;
    return std::any_of(group.stretches.rbegin(), group.stretches.rend(),
                       [&](int other) { return areLinked(stretch, other); });
  };
  auto& all = groups.groups;
  std::size_t joined = groups.count;
  for (std::size_t i = 0; i < groups.count; ++i) {
    if (!isOf(all[i])) continue;
    if (joined == groups.count)
      joined = i;
    else
      all[joined].takeOver(all[i]);
  }
  if (joined == all.size()) all.emplace_back();
  all[joined].add(one, stretch);
  // The others close up, in their order.
  std::size_t last = joined;
  for (std::size_t i = joined + 1; i < groups.count; ++i) {
    if (all[i].points.empty()) continue;
    std::swap(all[last], all[i]);
    if (joined == last) joined = i;
    ++last;
  }
  std::swap(all[last], all[joined]);
  groups.count = last + 1;
}

/// Apart by the side that points are seen from, and by what keyframes hang together.
void SharedSurfaces::visitCell(const PointsByCell& points, const PointsByCell::Cell& cell, Groups& groups,
                               const Visit& visit) const {
  groups.count = 0;
  for (std::size_t i = cell.begin; i < cell.end; ++i) join(points.at(i), groups);
  for (std::size_t i = 0; i < groups.count; ++i) {
    Group& group = groups.groups[i];
    groups.surface.seen.swap(group.points);
    visitGroup(points, cell, groups.surface, visit);
    groups.surface.seen.swap(group.points);
    group.points.clear(), group.stretches.clear();
  }
}

/// A cell alone is too small to tell which way a wall runs through it: what is around it tells that. A wall
/// says nothing of where along it one stands; anything else is where its points are.
void SharedSurfaces::visitGroup(const PointsByCell& points, const PointsByCell::Cell& cell,
                                SharedSurface& surface, const Visit& visit) const {
  const PointsInCell& first = *surface.seen.front();
  std::int8_t reach = 1;
  bool is_shared = false;
  for (const PointsInCell* one : surface.seen)
    is_shared = is_shared || one->keyframe != first.keyframe, reach = std::max(reach, one->reach);
  if (!is_shared) return;
  PointsByCell::Sums sums = points.around(cell, reach, first, cell_m_);
  scanmatch::Spread spread = sums.spread();
  const bool is_wall = isFlat(spread);
  if (!is_wall) {
    sums = {};
    for (const PointsInCell* one : surface.seen)
      if (areOnOneSide(*one, first)) sums.add(sumsOf(*one), 1, 0, 0);
    spread = sums.spread();
  }
  if (sums.n < kLeastPoints) return;
  surface.centre = {(cell.column + 0.5) * cell_m_, (cell.row + 0.5) * cell_m_};
  surface.mean = meanOf(spread), surface.direction = directionOf(spread);
  surface.variance = spread.across + blur2_;
  visit(surface);
  if (is_wall || isFlat(spread)) return;
  surface.direction = {-surface.direction.y, surface.direction.x};
  surface.variance = spread.along + blur2_;
  visit(surface);
}

}  // namespace slam::bundle
