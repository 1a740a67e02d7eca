#include "libslam/choices/passers.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::choices {
namespace {

using core::Point2;

/// No side of a person's returns or cells is longer; what is seen beside them lies so far away.
constexpr double kPerson_m = 0.6, kApart_m = 0.2;
constexpr size_t kLeastReturns = 2;
/// Scans are compared over a moment in which somebody who walks moves by more than he is thick, and the
/// robot's pose errs by little; the older one has to have looked so far beyond.
constexpr double kMoment_s = 0.6, kLongest_s = 2, kBehind_m = 0.2;
/// By how much the pose has moved otherwise than it was told, so much may a return have moved: where that is
/// more, the scans cannot be compared. Beside a place is looked at in such steps.
constexpr double kMostSlip_m = 0.3, kStep_m = 0.05;
/// Once may be chance.
constexpr int kLeastScans = 3;
/// A body reaches so far from a leg.
constexpr double kBody_m = 0.2;
constexpr int kAround = 8;

/// The longer side of the upright box around them.
double sideOf(const std::vector<Point2>& points) {
  const auto by_x =
      std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.x < b.x; });
  const auto by_y =
      std::minmax_element(points.begin(), points.end(), [](auto& a, auto& b) { return a.y < b.y; });
  return std::max(by_x.second->x - by_x.first->x, by_y.second->y - by_y.first->y);
}

/// How many of the points, from the first on, lie close together in their order.
size_t runLength(const std::vector<Point2>& points, size_t first) {
  size_t end = first + 1;
  while (end < points.size() && core::distance(points[end - 1], points[end]) < kApart_m) ++end;
  return end - first;
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

void makeFree(paths::FreeSpace& space, std::size_t cell, paths::CellBlock& freed) {
  space.state[cell] = paths::kFreeCell;
  const int column = static_cast<int>(cell % static_cast<std::size_t>(space.columns)),
            row = static_cast<int>(cell / static_cast<std::size_t>(space.columns));
  freed = paths::joined(freed, {column, row, column + 1, row + 1});
}

}  // namespace

Passers::Passers() {
  all_round_.width_rad = 2 * core::kPi;
  all_round_.reach_m = 0;
  all_round_.depth_margin_m = 0;
}

bool Passers::areAbout() const {
  return scans_with_newcomers_ >= kLeastScans;
}

/// The newest look that lies a moment back; null where there is none.
const Passers::Look* Passers::before(double time_s) {
  if (!looks_.empty() && !(time_s > looks_.back().time_s)) looks_.clear();
  while (!looks_.empty() && time_s - looks_.front().time_s > kLongest_s) looks_.pop_front();
  const Look* found = nullptr;
  for (const Look& look : looks_)
    if (time_s - look.time_s >= kMoment_s) found = &look;
  return found;
}

/// How far the pose has moved otherwise than it was told since.
core::Pose2 Passers::slip(const Look& since, const core::Pose2& T_map_robot) const {
  return core::between(core::between(since.T_start_told, T_start_told_),
                       core::between(since.T_map_robot, T_map_robot));
}

/// Whether a look has seen beyond a place and beyond all beside it that may be the same place.
bool Passers::isLookedThrough(const Look& look, const core::Pose2& slip, const Point2& p_map) {
  const Point2 p = core::inverse(look.T_map_robot) * p_map, lidar = core::position(look.T_robot_lidar);
  const double away_m = core::distance(lidar, p);
  const double slip_m = core::hypot(slip.x, slip.y) + std::abs(slip.phi) * away_m;
  if (!(away_m > 0) || slip_m > kMostSlip_m) return false;
  const Point2 along{(p.x - lidar.x) / away_m, (p.y - lidar.y) / away_m};
  const int steps = static_cast<int>(std::ceil(slip_m / kStep_m));
  const double behind_m = kBehind_m + slip_m;
  for (int k = -steps; k <= steps; ++k) {
    const double aside_m = steps > 0 ? k * slip_m / steps : 0;
    if (!look.view.contains(
            {p.x + behind_m * along.x - aside_m * along.y, p.y + behind_m * along.y + aside_m * along.x}))
      return false;
  }
  return true;
}

void Passers::see(const lidar::Scan& scan, const core::Pose2& T_map_robot, double cell_m) {
  const Look* old = before(scan.time_s);
  const core::Pose2 slipped = old == nullptr ? core::Pose2{} : slip(*old, T_map_robot);
  auto points = lidar::scanPoints(scan);
  seen_now_.clear();
  bodies_.clear();
  for (auto& p : points) p = T_map_robot * p;
  bool has_anybody_come = false;
  for (size_t first = 0, count = 0; first < points.size(); first += count) {
    count = runLength(points, first);
    const auto run = points.begin() + static_cast<std::ptrdiff_t>(first),
               end = run + static_cast<std::ptrdiff_t>(count);
    if (count < kLeastReturns || sideOf({run, end}) > kPerson_m) continue;
    const bool has_come = old != nullptr && std::all_of(run, end, [&](const Point2& p) {
                            return isLookedThrough(*old, slipped, p);
                          });
    const auto known = static_cast<size_t>(std::count_if(
        run, end, [&](const Point2& p) { return passed_.contains(core::planeCell(p, cell_m)); }));
    if (!has_come && 2 * known < count) continue;
    has_anybody_come = has_anybody_come || has_come;
    for (auto p = run; p != end; ++p) {
      if (has_come) passed_.insertAround(*p, cell_m);
      for (int k = 0; k < kAround; ++k)
        bodies_.push_back(core::Pose2{p->x, p->y, k * 2 * core::kPi / kAround} * Point2{kBody_m, 0});
    }
  }
  scans_with_newcomers_ += has_anybody_come;
  if (areAbout())
    for (const auto& p : points) seen_now_.insertAround(p, cell_m);
  else
    bodies_.clear();
  looks_.push_back(
      {scan.time_s, T_map_robot, T_start_told_, scan.T_robot_lidar, obstacles::LidarView(scan, all_round_)});
}

paths::CellBlock Passers::takeOutOf(paths::FreeSpace& space) const {
  paths::CellBlock freed;
  if (!areAbout()) return freed;
  for (std::size_t cell = 0; cell < space.state.size(); ++cell) {
    if (space.state[cell] != paths::kOccupiedCell) continue;
    const core::PlaneCell place = core::planeCell(space.centreOf(cell), space.resolution_m);
    if (passed_.contains(place) && !seen_now_.contains(place)) makeFree(space, cell, freed);
  }
  return are_small_things_suspected_ ? paths::joined(freed, takeOutSmallThings(space)) : freed;
}

paths::CellBlock Passers::takeOutSmallThings(paths::FreeSpace& space) const {
  paths::CellBlock freed;
  std::vector<char> is_known(space.state.size(), 0);
  for (std::size_t cell = 0; cell < space.state.size(); ++cell) {
    if (is_known[cell] || space.state[cell] != paths::kOccupiedCell) continue;
    const auto thing = thingAt(space, cell, is_known);
    std::vector<Point2> places;
    places.reserve(thing.size());
    for (const std::size_t part : thing) places.push_back(space.centreOf(part));
    const bool is_seen = std::any_of(places.begin(), places.end(), [&](const Point2& p) {
      return seen_now_.contains(core::planeCell(p, space.resolution_m));
    });
    if (is_seen || sideOf(places) > kPerson_m) continue;
    for (const std::size_t part : thing) makeFree(space, part, freed);
  }
  return freed;
}

}  // namespace slam::choices
