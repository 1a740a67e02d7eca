#include "libslam/bundle/points_by_cell.h"

#include <algorithm>
#include <limits>
#include <tuple>

namespace slam::bundle {
namespace {

/// Of a number that is sorted by, so many are looked at in one go: as many counts as the fastest cache holds.
constexpr int kDigitBits = 12;

}  // namespace

/// Counts, so that equal ones stay in their order.
template <class KeyOf>
void PointsByCell::sortBy(const KeyOf& key_of, std::vector<Place>& sorted) {
  std::int64_t least = std::numeric_limits<std::int64_t>::max(), most = least;
  if (!places_.empty()) most = least = key_of(places_.front());
  for (const Place& place : places_) {
    const std::int64_t key = key_of(place);
    least = std::min(least, key), most = std::max(most, key);
  }
  constexpr std::size_t kDigits = 1 << kDigitBits;
  std::array<std::uint32_t, kDigits> next;
  const auto range = static_cast<std::uint64_t>(most - least);
  for (int shift = 0; range >> shift > 0; shift += kDigitBits) {
    const auto digitOf = [&](const Place& place) {
      return (static_cast<std::uint64_t>(key_of(place) - least) >> shift) % kDigits;
    };
    next.fill(0);
    for (const Place& place : places_) ++next[digitOf(place)];
    std::uint32_t before = 0;
    for (std::uint32_t& count : next) {
      const std::uint32_t own = count;
      count = before, before += own;
    }
    sorted.resize(places_.size());
    for (const Place& place : places_) sorted[next[digitOf(place)]++] = place;
    places_.swap(sorted);
  }
}

void PointsByCell::sort() {
  places_.clear();
  places_.reserve(all_.size());
  for (std::size_t i = 0; i < all_.size(); ++i)
    if (all_[i].n > 0) places_.push_back({all_[i].row, all_[i].column, static_cast<std::uint32_t>(i)});
  std::vector<Place> sorted;
  sortBy([](const Place& place) { return std::int64_t{place.column}; }, sorted);
  sortBy([](const Place& place) { return std::int64_t{place.row}; }, sorted);
}

void PointsByCell::sumUp() {
  sort();
  cells_.clear();
  sides_.clear();
  std::size_t done = 0;
  for (std::size_t begin = 0, end = 0; begin < places_.size();) {
    const Place cell = places_[begin];
    const std::size_t first = done;
    for (; begin < places_.size() && areInOneCell(places_[begin], cell); begin = end) {
      const int keyframe = at(begin).keyframe;
      end = begin + 1;
      while (end < places_.size() && areInOneCell(places_[end], cell) && at(end).keyframe == keyframe) ++end;
      done = sumUpKeyframe(begin, end, done);
    }
    endCell(first, done);
  }
  places_.resize(done);
  findNear();
}

/// Those of one cell; what is left comes to `to`. Returns the place after it.
std::size_t PointsByCell::sumUpKeyframe(std::size_t begin, std::size_t end, std::size_t to) {
  if (end == begin + 1) {
    places_[to] = places_[begin];
    return to + 1;
  }
  // In an order that is the same wherever they come from: sums of floats depend on it.
  std::sort(places_.begin() + static_cast<std::ptrdiff_t>(begin),
            places_.begin() + static_cast<std::ptrdiff_t>(end), [&](const Place& a, const Place& b) {
              const PointsInCell &p = all_[a.index], &q = all_[b.index];
              return std::tie(p.x, p.y, p.n, a.index) < std::tie(q.x, q.y, q.n, b.index);
            });
  const std::size_t first = to;
  for (; begin < end; ++begin) {
    PointsInCell& one = at(begin);
    std::size_t same = to;
    while (same > first && !areOnOneSide(at(same - 1), one)) --same;
    if (same == first) {
      places_[to++] = places_[begin];
      continue;
    }
    PointsInCell& sum = at(same - 1);
    sum.n += one.n, sum.x += one.x, sum.y += one.y, sum.nx += one.nx, sum.ny += one.ny;
    sum.xx += one.xx, sum.xy += one.xy, sum.yy += one.yy, sum.reach = std::max(sum.reach, one.reach);
    one.n = 0;
  }
  return to;
}

void PointsByCell::endCell(std::size_t begin, std::size_t end) {
  const auto first_side = static_cast<std::ptrdiff_t>(sides_.size());
  for (std::size_t i = begin; i < end; ++i) {
    const PointsInCell& one = at(i);
    const auto side = std::find_if(sides_.begin() + first_side, sides_.end(),
                                   [&](const Side& known) { return known.fan.takes(one); });
    if (side == sides_.end()) {
      sides_.push_back({Fan(one), sumsOf(one)});
    } else {
      side->fan.add(one);
      side->sums.add(sumsOf(one), 1, 0, 0);
    }
  }
  cells_.push_back({places_[begin].row,
                    places_[begin].column,
                    static_cast<std::uint32_t>(begin),
                    static_cast<std::uint32_t>(end),
                    static_cast<std::uint32_t>(first_side),
                    static_cast<std::uint32_t>(sides_.size()),
                    {}});
}

void PointsByCell::findNear() {
  for (int i = 0; i <= 2 * kReach; ++i) {
    std::size_t next = 0;
    for (Cell& cell : cells_) {
      const std::pair first(cell.row + i - kReach, cell.column - kReach);
      while (next < cells_.size() && std::pair(cells_[next].row, cells_[next].column) < first) ++next;
      cell.first_near[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(next);
    }
  }
}

PointsByCell::Sums PointsByCell::around(const Cell& cell, int reach, const PointsInCell& first,
                                        double cell_m) const {
  Sums sums;
  for (int row = -reach; row <= reach; ++row) {
    const int of_near = kReach + row;
    for (std::size_t i = cell.first_near[static_cast<std::size_t>(of_near)]; i < cells_.size(); ++i) {
      const Cell& near = cells_[i];
      const std::int32_t column = near.column - cell.column;
      if (near.row != cell.row + row || column > reach) break;
      if (column >= -reach) addCell(near, first, column * cell_m, row * cell_m, sums);
    }
  }
  return sums;
}

/// What is seen from that side. Point by point where a fan lies astride.
void PointsByCell::addCell(const Cell& cell, const PointsInCell& first, double x_m, double y_m,
                           Sums& sums) const {
  bool is_clear = true;
  for (std::size_t i = cell.first_side; i < cell.after_side; ++i)
    is_clear = is_clear && sides_[i].fan.areAllOnSideOf(first) == sides_[i].fan.isAnyOnSideOf(first);
  if (is_clear) {
    for (std::size_t i = cell.first_side; i < cell.after_side; ++i)
      if (sides_[i].fan.isAnyOnSideOf(first)) sums.add(sides_[i].sums, 1, x_m, y_m);
  } else {
    for (std::size_t i = cell.begin; i < cell.end; ++i)
      if (areOnOneSide(at(i), first)) sums.add(sumsOf(at(i)), 1, x_m, y_m);
  }
}

}  // namespace slam::bundle
