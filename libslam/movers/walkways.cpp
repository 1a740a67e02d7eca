#include "libslam/movers/walkways.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "libslam/world/region.h"

namespace slam::movers {
namespace {

constexpr double kLongestWalk_m = 30, kAreaPerPlace_m2 = 12, kBetweenPlaces_m = 1.5, kRoomToPass_m = 0.35;
constexpr size_t kFewestPlaces = 6, kMostPlaces = 256, kWaysPerPlace = 5;
constexpr double kStartReach_m = 1.0;
constexpr double kRoundingReserve = 1e-6;  // of a cell
// 7 / 5 for the square root of 2: whole numbers, and at most 1.1 % wrong.
constexpr int kStraight = 5, kDiagonal = 7;
constexpr std::uint16_t kNotReached = std::numeric_limits<std::uint16_t>::max();

double squared(double x) {
  return x * x;
}

}  // namespace

Walkways::Walkways(const world::Plan& plan, double radius_m, std::uint64_t seed, const core::Point2& p_start)
    : columns_(plan.columns),
      rows_(plan.rows),
      resolution_m_(plan.resolution_m),
      cells_per_metre_(1 / plan.resolution_m),
      reach_(radius_m / plan.resolution_m + std::sqrt(0.5) + kRoundingReserve),
      open_(plan.cells.size(), 0),
      cost_(plan.cells.size(), kNotReached),
      seed_(seed) {
  fill(plan, 0, 0, columns_, rows_, open_);
  now_ = open_;
  drawPlaces(plan, regionFrom(p_start), radius_m, core::RandomStream(seed, "places"));
}

core::Point2 Walkways::centreOf(size_t cell) const {
  const auto columns = static_cast<size_t>(columns_);
  const size_t column = cell % columns, row = cell / columns;
  return {resolution_m_ * (static_cast<double>(column) + 0.5),
          resolution_m_ * (static_cast<double>(row) + 0.5)};
}

void Walkways::fill(const world::Plan& plan, int x0, int y0, int x1, int y1, Mask& mask) const {
  // One can stand on a free cell without a wall within reach_ of its centre. Half widths of that disc by
  // rows:
  const int most = static_cast<int>(std::floor(reach_ + 0.5));
  std::vector<int> half_widths;
  for (int dy = 0; dy <= most; ++dy) {
    const double gap = std::max(0.0, dy - 0.5);
    half_widths.push_back(static_cast<int>(std::floor(std::sqrt(squared(reach_) - squared(gap)) + 0.5)));
  }
  std::vector<int> to_wall(static_cast<size_t>(x1 - x0));  // of each column, along the row looked at
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      mask[static_cast<size_t>(y) * static_cast<size_t>(columns_) + static_cast<size_t>(x)] =
          plan.at(x, y) == world::Cell::kFree && x >= most && y >= most && x + most < columns_ &&
          y + most < rows_;
  for (int wall_y = std::max(0, y0 - most); wall_y < std::min(rows_, y1 + most); ++wall_y) {
    const auto isWall = [&](int x) {
      return x >= 0 && x < columns_ && plan.at(x, wall_y) == world::Cell::kOccupied;
    };
    int distance = most + 1;
    for (int x = x0 - most; x < x1; ++x) {
      distance = isWall(x) ? 0 : distance + 1;
      if (x >= x0) to_wall[static_cast<size_t>(x - x0)] = distance;
    }
    distance = most + 1;
    for (int x = x1 + most - 1; x >= x0; --x) {
      distance = isWall(x) ? 0 : distance + 1;
      if (x < x1) {
        int& nearest = to_wall[static_cast<size_t>(x - x0)];
        nearest = std::min(nearest, distance);
      }
    }
    for (int y = std::max(y0, wall_y - most); y < std::min(y1, wall_y + most + 1); ++y) {
      const int half_width = half_widths[static_cast<size_t>(std::abs(y - wall_y))];
      auto* line = mask.data() + static_cast<size_t>(y) * static_cast<size_t>(columns_) + x0;
      for (size_t i = 0; i < to_wall.size(); ++i)
        line[i] = static_cast<std::uint8_t>(line[i] & (to_wall[i] > half_width));
    }
  }
}

void Walkways::update(const world::Plan& plan, int x0, int y0, int x1, int y1) {
  const int margin = static_cast<int>(std::ceil(reach_)) + 1;
  fill(plan, std::max(0, x0 - margin), std::max(0, y0 - margin), std::min(columns_, x1 + margin),
       std::min(rows_, y1 + margin), now_);
}

double Walkways::freeDistance(const core::Point2& p, const core::Point2& direction, double limit_m) const {
  const double step_m = 0.75 * resolution_m_;
  const int steps = static_cast<int>(std::ceil(limit_m / step_m));
  for (int i = 1; i <= steps; ++i) {
    const double s = std::min(limit_m, i * step_m);
    if (!canStand({p.x + s * direction.x, p.y + s * direction.y})) return (i - 1) * step_m;
  }
  return limit_m;
}

bool Walkways::isClear(const core::Point2& a, const core::Point2& b) const {
  const double dx = b.x - a.x, dy = b.y - a.y;
  const int steps = 1 + static_cast<int>(std::max(std::abs(dx), std::abs(dy)) / (0.5 * resolution_m_));
  for (int i = 0; i <= steps; ++i) {
    const double s = static_cast<double>(i) / steps;
    if (!test(open_, {a.x + s * dx, a.y + s * dy})) return false;
  }
  return true;
}

std::vector<std::uint32_t> Walkways::regionFrom(const core::Point2& p_start) const {
  const auto columns = static_cast<size_t>(columns_);
  size_t nearest = open_.size();
  double least = squared(kStartReach_m);
  const auto index = [&](double metres, int size) {
    return static_cast<int>(std::clamp(std::floor(metres / resolution_m_), 0.0, static_cast<double>(size)));
  };
  const int x1 = index(p_start.x + kStartReach_m, columns_), y1 = index(p_start.y + kStartReach_m, rows_);
  for (int y = index(p_start.y - kStartReach_m, rows_); y < y1; ++y)
    for (int x = index(p_start.x - kStartReach_m, columns_); x < x1; ++x) {
      const size_t cell = static_cast<size_t>(y) * columns + static_cast<size_t>(x);
      const core::Point2 p = centreOf(cell);
      const double d = squared(p.x - p_start.x) + squared(p.y - p_start.y);
      if (open_[cell] && d < least) least = d, nearest = cell;
    }
  std::vector<std::uint32_t> region;
  if (nearest == open_.size()) {
    const auto largest = world::largestRegion(columns_, std::vector<char>(open_.begin(), open_.end()));
    region.assign(largest.begin(), largest.end());
    return region;
  }
  Mask left = open_;
  left[nearest] = 0;
  region.push_back(static_cast<std::uint32_t>(nearest));
  for (size_t done = 0; done < region.size(); ++done)
    // The mask's rim is 0: nobody fits at the plan's edge.
    for (const size_t next :
         {region[done] - 1UL, region[done] + 1UL, region[done] - columns, region[done] + columns})
      if (left[next]) left[next] = 0, region.push_back(static_cast<std::uint32_t>(next));
  // In an order that does not depend on where in the region the robot starts.
  region.clear();
  for (size_t cell = 0; cell < open_.size(); ++cell)
    if (open_[cell] != left[cell]) region.push_back(static_cast<std::uint32_t>(cell));
  return region;
}

void Walkways::drawPlaces(const world::Plan& plan, const std::vector<std::uint32_t>& region, double radius_m,
                          core::RandomStream random) {
  if (region.empty()) return;
  const double area_m2 = static_cast<double>(region.size()) * squared(resolution_m_);
  const size_t wanted =
      std::clamp(static_cast<size_t>(area_m2 / kAreaPerPlace_m2), kFewestPlaces, kMostPlaces);
  const auto isFarFromOthers = [&](const core::Point2& p) {
    return std::none_of(places_.begin(), places_.end(), [&](size_t other) {
      const core::Point2 q = centreOf(other);
      return squared(p.x - q.x) + squared(p.y - q.y) < squared(kBetweenPlaces_m);
    });
  };
  const double room_m = radius_m + kRoomToPass_m;
  const auto isInDoorway = [&](const core::Point2& p) {
    return std::any_of(plan.doors.begin(), plan.doors.end(), [&](const world::Door& door) {
      return p.x > door.x0 * resolution_m_ - room_m && p.x < door.x1 * resolution_m_ + room_m &&
             p.y > door.y0 * resolution_m_ - room_m && p.y < door.y1 * resolution_m_ + room_m;
    });
  };
  for (const bool with_room : {true, false}) {
    for (size_t tries = 0; tries < 30 * wanted && places_.size() < wanted; ++tries) {
      const size_t cell = region[random.below(region.size())];
      const core::Point2 p = centreOf(cell);
      const bool has_room = !isInDoorway(p) && !world::discCollides(plan, plan.T_frame_raster * p, room_m);
      if ((has_room || !with_room) && isFarFromOthers(p)) places_.push_back(cell);
    }
    if (places_.size() > 1) return;
  }
  if (places_.empty()) places_.push_back(region.front());
}

/// Costs from a place to all that is within a walk, by buckets (Dial, Communications of the ACM 12(11),
/// 1969).
void Walkways::flood(size_t from, std::vector<size_t>& reached) {
  const int longest =
      std::min<int>(kNotReached - 1, static_cast<int>(kStraight * kLongestWalk_m / resolution_m_));
  const auto columns = static_cast<std::ptrdiff_t>(columns_);
  std::array<std::vector<size_t>, kDiagonal + 1> buckets;
  buckets[0].push_back(from);
  cost_[from] = 0;
  size_t waiting = 1;
  for (int cost = 0; waiting > 0 && cost <= longest; ++cost) {
    auto& bucket = buckets[static_cast<size_t>(cost) % buckets.size()];
    for (size_t done = 0; done < bucket.size(); ++done) {
      const size_t cell = bucket[done];
      --waiting;
      if (cost_[cell] != cost) continue;
      reached.push_back(cell);
      const auto at = [&](std::ptrdiff_t by) {
        return static_cast<size_t>(static_cast<std::ptrdiff_t>(cell) + by);
      };
      const auto open = [&](size_t next, int step) {
        if (!open_[next] || cost + step >= cost_[next] || cost + step > longest) return;
        cost_[next] = static_cast<std::uint16_t>(cost + step);
        buckets[static_cast<size_t>(cost + step) % buckets.size()].push_back(next);
        ++waiting;
      };
      for (const std::ptrdiff_t by : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, columns, -columns})
        open(at(by), kStraight);
      for (const std::ptrdiff_t dx : {1, -1})
        for (const std::ptrdiff_t dy : {columns, -columns})
          if (open_[at(dx)] && open_[at(dy)]) open(at(dx + dy), kDiagonal);
    }
    bucket.clear();
  }
}

/// From a reached cell down to the flood's source; straight where one can see, so with few corners.
std::vector<core::Point2> Walkways::descend(size_t cell) const {
  const auto columns = static_cast<std::ptrdiff_t>(columns_);
  std::vector<core::Point2> points{centreOf(cell)};
  while (cost_[cell] > 0) {
    const auto at = [&](std::ptrdiff_t by) {
      return static_cast<size_t>(static_cast<std::ptrdiff_t>(cell) + by);
    };
    size_t next = cell;
    for (const std::ptrdiff_t by : {std::ptrdiff_t{1}, std::ptrdiff_t{-1}, columns, -columns})
      if (open_[at(by)] && cost_[at(by)] + kStraight == cost_[cell]) next = at(by);
    for (const std::ptrdiff_t dx : {1, -1})
      for (const std::ptrdiff_t dy : {columns, -columns})
        if (open_[at(dx)] && open_[at(dy)] && open_[at(dx + dy)] &&
            cost_[at(dx + dy)] + kDiagonal == cost_[cell])
          next = at(dx + dy);
    cell = next;
    points.push_back(centreOf(cell));
  }
  std::vector<core::Point2> corners{points.front()};
  constexpr size_t kStride = 8;  // looking at each point in turn takes most of the time of finding ways
  for (size_t seen = 0; seen + 1 < points.size();) {
    const size_t ahead = std::min(seen + kStride, points.size() - 1);
    if (isClear(corners.back(), points[ahead])) {
      seen = ahead;
      continue;
    }
    while (isClear(corners.back(), points[seen + 1])) ++seen;
    corners.push_back(points[seen]);
  }
  corners.push_back(points.back());
  std::reverse(corners.begin(), corners.end());
  return corners;
}

const std::vector<Walkways::Way>& Walkways::waysFrom(size_t place) {
  const auto [entry, is_new] = ways_.try_emplace(place);
  auto& ways = entry->second;
  if (!is_new) return ways;
  std::vector<size_t> reached, goals;
  flood(places_[place], reached);
  for (size_t other = 0; other < places_.size(); ++other)
    if (other != place && cost_[places_[other]] != kNotReached) goals.push_back(other);
  core::RandomStream random(seed_, "ways " + std::to_string(place));
  for (size_t i = 0; i < std::min(kWaysPerPlace, goals.size()); ++i) {
    std::swap(goals[i], goals[i + random.below(goals.size() - i)]);
    ways.push_back({goals[i], descend(places_[goals[i]])});
  }
  if (ways.empty()) ways.push_back({place, {centreOf(places_[place]), centreOf(places_[place])}});
  for (const size_t cell : reached) cost_[cell] = kNotReached;
  return ways;
}

}  // namespace slam::movers
