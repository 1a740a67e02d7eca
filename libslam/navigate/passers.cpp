#include "libslam/navigate/passers.h"

#include <algorithm>
#include <cmath>

namespace slam::navigate {
namespace {

using core::Point2;

/// A return so far from all that is not free is somebody who has come.
constexpr double kAmidst_m = 0.15;
/// No side of a person's returns or cells is longer; what is seen behind lies so far from them.
constexpr double kPerson_m = 0.6, kApart_m = 0.2;

/// A body reaches so far from a leg.
constexpr double kBody_m = 0.2;
constexpr int kAround = 8;

struct Box {
  Point2 least{1e300, 1e300}, most{-1e300, -1e300};
  void add(const Point2& p) {
    least = {std::min(least.x, p.x), std::min(least.y, p.y)};
    most = {std::max(most.x, p.x), std::max(most.y, p.y)};
  }
  double side() const { return std::max(most.x - least.x, most.y - least.y); }
};

bool isAmongFree(const paths::FreeSpace& space, const Point2& p) {
  const int column = space.columnOf(p.x), row = space.rowOf(p.y);
  const int reach = static_cast<int>(std::ceil(kAmidst_m / space.resolution_m));
  for (int r = row - reach; r <= row + reach; ++r)
    for (int c = column - reach; c <= column + reach; ++c)
      if (!space.contains(c, r) || space.state[space.index(c, r)] != paths::kFreeCell) return false;
  return true;
}

/// The occupied cells that hang together with this one; marks them.
std::vector<std::size_t> thingAt(const paths::FreeSpace& space, std::size_t cell,
                                 std::vector<char>& is_known) {
  std::vector<std::size_t> thing = {cell};
  is_known[cell] = 1;
  for (std::size_t i = 0; i < thing.size(); ++i) {
    const int column = static_cast<int>(thing[i] % static_cast<std::size_t>(space.columns)),
              row = static_cast<int>(thing[i] / static_cast<std::size_t>(space.columns));
    for (int r = row - 1; r <= row + 1; ++r)
      for (int c = column - 1; c <= column + 1; ++c) {
        if (!space.contains(c, r)) continue;
        const std::size_t next = space.index(c, r);
        if (is_known[next] || space.state[next] != paths::kOccupiedCell) continue;
        is_known[next] = 1;
        thing.push_back(next);
      }
  }
  return thing;
}

}  // namespace

Passers::Place Passers::placeOf(const Point2& p_map, double cell_m) {
  const auto at = [&](double x_m) { return static_cast<Place>(std::floor(x_m / cell_m)); };
  return at(p_map.y) * (Place{1} << 32) + at(p_map.x);
}

void Passers::see(const std::vector<Point2>& points_map, const paths::FreeSpace& space) {
  seen_now_.clear();
  bodies_.clear();
  for (const Point2& p : points_map) mark(p, space.resolution_m, seen_now_);
  // Runs of returns close together, and what lies before and behind them in the scan.
  for (std::size_t begin = 0, end = 0; begin < points_map.size(); begin = end) {
    Box box;
    bool is_amid = true;
    do {
      box.add(points_map[end]);
      is_amid = is_amid && isAmongFree(space, points_map[end]);
      ++end;
    } while (end < points_map.size() && core::distance(points_map[end - 1], points_map[end]) < kApart_m);
    if (!is_amid || box.side() > kPerson_m) continue;
    for (std::size_t i = begin; i < end; ++i) {
      mark(points_map[i], space.resolution_m, passed_);
      for (int k = 0; k < kAround; ++k) {
        const Point2 reach = core::polar(kBody_m, k * 2 * core::kPi / kAround);
        bodies_.push_back({points_map[i].x + reach.x, points_map[i].y + reach.y});
      }
    }
  }
  ++scans_;
  if (!bodies_.empty()) ++scans_with_people_;
  if (!areAbout()) bodies_.clear();
}

/// The cell of a point, and those beside it.
void Passers::mark(const Point2& p, double cell_m, std::unordered_set<Place>& places) {
  for (const double dy : {-cell_m, 0.0, cell_m})
    for (const double dx : {-cell_m, 0.0, cell_m}) places.insert(placeOf({p.x + dx, p.y + dy}, cell_m));
}

void Passers::takeOutOf(paths::FreeSpace& space) const {
  if (!areAbout()) return;
  for (std::size_t cell = 0; cell < space.state.size(); ++cell) {
    if (space.state[cell] != paths::kOccupiedCell) continue;
    const Place place = placeOf(space.centreOf(cell), space.resolution_m);
    if (passed_.count(place) != 0 && seen_now_.count(place) == 0) space.state[cell] = paths::kFreeCell;
  }
  if (are_small_things_suspected_) takeOutSmallThings(space);
}

void Passers::takeOutSmallThings(paths::FreeSpace& space) const {
  std::vector<char> is_known(space.state.size(), 0);
  for (std::size_t cell = 0; cell < space.state.size(); ++cell) {
    if (is_known[cell] || space.state[cell] != paths::kOccupiedCell) continue;
    const auto thing = thingAt(space, cell, is_known);
    Box box;
    bool is_seen = false;
    for (const std::size_t part : thing) {
      const Point2 p = space.centreOf(part);
      box.add(p);
      is_seen = is_seen || seen_now_.count(placeOf(p, space.resolution_m)) != 0;
    }
    if (is_seen || box.side() > kPerson_m) continue;
    for (const std::size_t part : thing) space.state[part] = paths::kFreeCell;
  }
}

}  // namespace slam::navigate
