#include "libslam/bundle/shared_surfaces.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

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

bool areOnOneSide(const PointsInCell& a, const PointsInCell& b) {
  return a.nx * b.nx + a.ny * b.ny >= 0;
}

scanmatch::ScanInCells::Sums sumsOf(const PointsInCell& one) {
  return {one.n, one.x, one.y, one.xx, one.xy, one.yy, one.nx, one.ny};
}

}  // namespace

bool SharedSurfaces::Spread::isFlat() const {
  return across < scanmatch::kFlat * along;
}

std::pair<std::int32_t, std::int32_t> SharedSurfaces::cellOf(const PointsInCell& one) {
  return {one.row, one.column};
}

std::size_t SharedSurfaces::endOfCell(const std::vector<PointsInCell>& all, std::size_t begin) {
  std::size_t end = begin;
  while (end < all.size() && cellOf(all[end]) == cellOf(all[begin])) ++end;
  return end;
}

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

bool SharedSurfaces::areLinked(const PointsInCell& a, const PointsInCell& b) const {
  const int from = stretch_[static_cast<std::size_t>(a.keyframe)],
            to = stretch_[static_cast<std::size_t>(b.keyframe)];
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
  std::int64_t row = std::numeric_limits<std::int64_t>::min() + kMargin;
  for (; nextWithPoints(row - kMargin) != kNone; row += kRowsOfBand) {
    // Walls may be moved to rows before those of points.
    row = std::max(row, nextWithPoints(row - kMargin) - kMargin);
    auto all = pointsIn({row - kMargin, row + kRowsOfBand + kMargin}, of_keyframes);
    sumUpByCell(all);
    gatherWalls(all);
    sumUpByCell(all);
    for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
      end = endOfCell(all, begin);
      if (all[begin].row >= row && all[begin].row < row + kRowsOfBand) visitCell(all, begin, end, visit);
    }
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

/// In the order of keyframes.
std::vector<PointsInCell> SharedSurfaces::pointsIn(const Rows& rows,
                                                   const std::vector<Rows>& of_keyframes) const {
  std::vector<PointsInCell> all;
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
        all.push_back({static_cast<std::int32_t>(row), static_cast<std::int32_t>(column), k, toFloat(s.n),
                       toFloat(s.x), toFloat(s.y), toFloat(s.xx), toFloat(s.xy), toFloat(s.yy), toFloat(s.nx),
                       toFloat(s.ny), 0});
  }
  return all;
}

/// A keyframe's points in a cell as one, where they are seen from one side.
void SharedSurfaces::sumUpByCell(std::vector<PointsInCell>& all) {
  // In place, and in an order that is the same everywhere: sums of floats depend on it.
  std::sort(all.begin(), all.end(), [](const PointsInCell& a, const PointsInCell& b) {
    return std::tie(a.row, a.column, a.keyframe, a.x, a.y, a.n) <
           std::tie(b.row, b.column, b.keyframe, b.x, b.y, b.n);
  });
  std::size_t end = 0;  // of those that are done
  for (const PointsInCell& one : all) {
    const auto isOfIt = [&](const PointsInCell& other) {
      return cellOf(other) == cellOf(one) && other.keyframe == one.keyframe;
    };
    std::size_t same = end;
    while (same > 0 && isOfIt(all[same - 1]) && !areOnOneSide(all[same - 1], one)) --same;
    if (same == 0 || !isOfIt(all[same - 1])) {
      all[end++] = one;
      continue;
    }
    PointsInCell& sum = all[same - 1];
    sum.n += one.n, sum.x += one.x, sum.y += one.y, sum.nx += one.nx, sum.ny += one.ny;
    sum.xx += one.xx, sum.xy += one.xy, sum.yy += one.yy, sum.reach = std::max(sum.reach, one.reach);
  }
  all.resize(end);
}

/// Noise spreads a wall's points over two cells or more, across it: all go to the one that the middle of the
/// wall is in. Each cell by itself would have the points whose noise has put them there. What looks like
/// clutter from nearby may be a wall seen with much noise: from farther off that shows, and it is believed if
/// the wall is not much thicker than others are here.
void SharedSurfaces::gatherWalls(std::vector<PointsInCell>& all) const {
  std::vector<Way> ways(all.size());
  std::vector<double> thickness2;
  findWalls(all, 1, core::kInfinity, ways, thickness2);
  if (!thickness2.empty()) {
    const auto middle = thickness2.begin() + static_cast<std::ptrdiff_t>(thickness2.size() / 2);
    std::nth_element(thickness2.begin(), middle, thickness2.end());
    const double most = kThickest * kThickest * *middle;
    findWalls(all, 2, most, ways, thickness2);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const auto [columns, rows, reach] = ways[i];
    PointsInCell& one = all[i];
    one.reach = reach;
    if (columns == 0 && rows == 0) continue;
    scanmatch::ScanInCells::Sums moved;
    moved.add(sumsOf(one), 1, -columns * cell_m_, -rows * cell_m_);
    one.x = toFloat(moved.x), one.y = toFloat(moved.y);
    one.xx = toFloat(moved.xx), one.xy = toFloat(moved.xy), one.yy = toFloat(moved.yy);
    one.column += columns, one.row += rows;
  }
}

/// Ways to the middle of walls of at most this variance across, of points that have none yet; the variances.
void SharedSurfaces::findWalls(const std::vector<PointsInCell>& all, std::int8_t reach, double most,
                               std::vector<Way>& ways, std::vector<double>& thickness2) const {
  const auto cells = [&](double m) { return static_cast<std::int8_t>(std::lround(m / cell_m_)); };
  Group around;
  for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
    end = endOfCell(all, begin);
    around.clear();
    for (std::size_t i = begin; i < end; ++i) {
      const auto wasTried = [&](std::size_t other) {
        return ways[other].reach == 0 && areOnOneSide(all[other], all[i]);
      };
      bool is_known = ways[i].reach != 0;
      for (std::size_t other = begin; other < i; ++other) is_known = is_known || wasTried(other);
      if (is_known) continue;
      if (around.empty()) around = neighbourhood(all, all[begin], reach);
      const Spread spread = spreadOf(around, all[i]);
      if (!spread.isFlat() || spread.across > most) continue;
      const double across_m = spread.direction.x * spread.mean.y - spread.direction.y * spread.mean.x;
      const Way way{cells(-spread.direction.y * across_m), cells(spread.direction.x * across_m), reach};
      thickness2.push_back(spread.across);
      for (std::size_t other = i; other < end; ++other)
        if (ways[other].reach == 0 && areOnOneSide(all[i], all[other])) ways[other] = way;
    }
  }
}

/// Apart by the side that points are seen from, and by what keyframes hang together.
void SharedSurfaces::visitCell(const std::vector<PointsInCell>& all, std::size_t begin, std::size_t end,
                               const Visit& visit) const {
  std::vector<Group> groups;
  for (std::size_t i = begin; i < end; ++i) {
    const PointsInCell& one = all[i];
    const auto isOf = [&](const Group& group) {
      if (!areOnOneSide(*group.front(), one)) return false;
      return std::any_of(group.rbegin(), group.rend(),
                         [&](const PointsInCell* other) { return areLinked(one, *other); });
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
  for (Group& group : groups) {
    std::int8_t reach = 1;
    for (const PointsInCell* one : group) reach = std::max(reach, one->reach);
    visitGroup(std::move(group), neighbourhood(all, all[begin], reach), visit);
  }
}

/// What lies in a cell and so far around it.
SharedSurfaces::Group SharedSurfaces::neighbourhood(const std::vector<PointsInCell>& all,
                                                    const PointsInCell& one, std::int32_t reach) {
  Group around;
  for (std::int32_t row = one.row - reach; row <= one.row + reach; ++row) {
    const std::pair first(row, one.column - reach), last(row, one.column + reach);
    auto next = std::lower_bound(all.begin(), all.end(), first,
                                 [](const PointsInCell& a, const auto& cell) { return cellOf(a) < cell; });
    for (; next != all.end() && cellOf(*next) <= last; ++next) around.push_back(&*next);
  }
  return around;
}

/// Of those that are seen from the side that `first` is seen from.
SharedSurfaces::Spread SharedSurfaces::spreadOf(const Group& group, const PointsInCell& first) const {
  scanmatch::ScanInCells::Sums sums;
  for (const PointsInCell* s : group)
    if (areOnOneSide(*s, first))
      sums.add(sumsOf(*s), 1, (s->column - first.column) * cell_m_, (s->row - first.row) * cell_m_);
  const scanmatch::Spread spread = sums.spread();
  // At half the angle of (half, xy).
  const auto [sine, cosine] = core::sinCos(0.5 * core::atan2(spread.xy, spread.half));
  return {sums.n, {spread.mx, spread.my}, {cosine, sine}, spread.along, spread.across};
}

/// A cell alone is too small to tell which way a wall runs through it: what is around it tells that. A wall
/// says nothing of where along it one stands; anything else is where its points are.
void SharedSurfaces::visitGroup(Group group, const Group& around, const Visit& visit) const {
  const PointsInCell& first = *group.front();
  const bool is_shared = std::any_of(
      group.begin(), group.end(), [&](const PointsInCell* one) { return one->keyframe != first.keyframe; });
  if (!is_shared) return;
  const Spread wide = spreadOf(around, first);
  const bool is_wall = wide.isFlat();
  const Spread spread = is_wall ? wide : spreadOf(group, first);
  if (spread.n < kLeastPoints) return;
  const auto& [x, y] = spread.direction;
  const core::Point2 centre{(first.column + 0.5) * cell_m_, (first.row + 0.5) * cell_m_};
  SharedSurface surface{std::move(group), centre, spread.direction, spread.mean, spread.across + blur2_};
  visit(surface);
  if (is_wall || spread.isFlat()) return;
  surface.direction = {-y, x}, surface.variance = spread.along + blur2_;
  visit(surface);
}

}  // namespace slam::bundle
