#include "libslam/oracle/bound_below.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>

#include "libslam/oracle/cell_sight.h"
#include "libslam/oracle/moats.h"
#include "libslam/world/clearance.h"

namespace slam::oracle {
namespace {

constexpr std::size_t kMostBlocks = 800, kMostGroups = 120;
constexpr double kLargestRegion = 0.25;                                  // of F
constexpr double kGrownRegions[] = {0.0, 0.01, 0.02, 0.04, 0.08, 0.15};  // of F
constexpr std::int32_t kNobody = -1;

/// F of the argument, and the neighbourhoods in it.
struct Floor {
  const world::Plan& plan;
  std::vector<char> in;
  std::size_t cells = 0, start = 0;

  template <class Visit>
  void around(std::size_t cell, Visit visit) const {
    const int column = static_cast<int>(cell % static_cast<std::size_t>(plan.columns));
    const int row = static_cast<int>(cell / static_cast<std::size_t>(plan.columns));
    for (int dr = -1; dr <= 1; ++dr)
      for (int dc = -1; dc <= 1; ++dc)
        if (plan.contains(column + dc, row + dr))
          visit(static_cast<std::size_t>(row + dr) * static_cast<std::size_t>(plan.columns) +
                static_cast<std::size_t>(column + dc));
  }
};

Floor floorOf(const world::Plan& plan, const core::Point2& start_world, double radius_m) {
  Floor floor{plan, std::vector<char>(plan.cells.size(), 0)};
  const core::Point2 start = world::pointToCells(plan, start_world);
  floor.start = static_cast<std::size_t>(start.y) * static_cast<std::size_t>(plan.columns) +
                static_cast<std::size_t>(start.x);
  // A hair less, so that rounding leaves nothing out.
  const double radius = radius_m / plan.resolution_m - std::sqrt(0.5) - 1e-6;
  const auto admits = world::admissibleCells(plan, std::max(0.0, radius));
  std::vector<std::size_t> open = {floor.start};
  floor.in[floor.start] = 1;
  while (!open.empty()) {
    const std::size_t cell = open.back();
    open.pop_back();
    ++floor.cells;
    floor.around(cell, [&](std::size_t next) {
      if (admits[next] && !floor.in[next]) floor.in[next] = 1, open.push_back(next);
    });
  }
  return floor;
}

/// The cells of F that see some of a block.
class Seers {
 public:
  Seers(const Floor& floor, double range_cells, int offset_cells)
      : floor_(floor), range_(range_cells), offset_(offset_cells), mark_(floor.in.size(), 0) {}

  /// Calls visit(cell of F), each once, until it answers false.
  template <class Visit>
  void visit(const Block& block, Visit visit) {
    ++stamp_;
    const auto columns = static_cast<std::ptrdiff_t>(floor_.plan.columns);
    const auto rows = static_cast<std::ptrdiff_t>(floor_.plan.rows);
    visitSeeing(floor_.plan, block, range_, [&](std::size_t seeing) {
      const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(seeing) % columns;
      const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(seeing) / columns;
      for (auto r = std::max<std::ptrdiff_t>(0, row - offset_); r <= std::min(rows - 1, row + offset_); ++r)
        for (auto c = std::max<std::ptrdiff_t>(0, column - offset_);
             c <= std::min(columns - 1, column + offset_); ++c) {
          const auto here = static_cast<std::size_t>(r * columns + c);
          if (!floor_.in[here] || mark_[here] == stamp_) continue;
          mark_[here] = stamp_;
          if (!visit(here)) return false;
        }
      return true;
    });
  }

 private:
  const Floor& floor_;
  double range_;
  std::ptrdiff_t offset_;
  std::vector<std::uint32_t> mark_;
  std::uint32_t stamp_ = 0;
};

/// Explorable cells side by side, and where they are seen from.
struct Witness {
  double cells = 0;
  std::int32_t moves = 0;  ///< of a chess king within F from the start to the nearest of these places
  std::vector<std::uint32_t> seen_from;  ///< cells of F; empty when they are many or the start is among them
};

std::vector<Witness> witnessesOf(const metrics::ExplorableArea& area, const Floor& floor, Seers& seers,
                                 const std::vector<std::int32_t>& moves, const std::function<void()>& go_on) {
  Block block;
  while (area.cells / static_cast<std::size_t>(block.side * block.side) > kMostBlocks) ++block.side;
  const auto most = static_cast<std::size_t>(kLargestRegion * static_cast<double>(floor.cells));
  std::vector<Witness> witnesses;
  for (block.row = 0; block.row < area.rows; block.row += block.side)
    for (block.column = 0; block.column < area.columns; block.column += block.side) {
      go_on();
      Witness witness;
      for (int row = block.row; row < std::min(area.rows, block.row + block.side); ++row)
        for (int column = block.column; column < std::min(area.columns, block.column + block.side); ++column)
          witness.cells +=
              area.explorable[static_cast<std::size_t>(row) * static_cast<std::size_t>(area.columns) +
                              static_cast<std::size_t>(column)];
      if (witness.cells == 0) continue;
      witness.moves = std::numeric_limits<std::int32_t>::max();
      seers.visit(block, [&](std::size_t seer) {
        witness.moves = std::min(witness.moves, moves[seer]);
        if (witness.seen_from.size() <= most) witness.seen_from.push_back(static_cast<std::uint32_t>(seer));
        return witness.moves > 0;
      });
      if (witness.seen_from.size() > most || witness.moves == 0) witness.seen_from = {};
      witnesses.push_back(std::move(witness));
    }
  std::stable_sort(witnesses.begin(), witnesses.end(),
                   [](const auto& a, const auto& b) { return a.seen_from.size() < b.seen_from.size(); });
  return witnesses;
}

/// Whose region each cell of F is; kNobody's where none is.
std::vector<std::int32_t> regionsOf(const std::vector<Witness>& witnesses, std::size_t cells,
                                    std::size_t most) {
  std::vector<std::int32_t> owner(cells, kNobody);
  std::vector<std::size_t> size;
  for (const auto& witness : witnesses) {
    const auto& seen_from = witness.seen_from;
    if (seen_from.empty()) continue;
    std::int32_t whose = kNobody;
    std::size_t more = 0;
    bool is_one = true;
    for (const std::uint32_t cell : seen_from) {
      if (owner[cell] == kNobody) {
        ++more;
        continue;
      }
      is_one = is_one && (whose == kNobody || whose == owner[cell]);
      whose = owner[cell];
    }
    if (!is_one) continue;
    if (whose == kNobody) {
      whose = static_cast<std::int32_t>(size.size());
      size.push_back(0);
    } else if (size[static_cast<std::size_t>(whose)] + more > most) {
      continue;
    }
    size[static_cast<std::size_t>(whose)] += more;
    for (const std::uint32_t cell : seen_from) owner[cell] = whose;
  }
  return owner;
}

/// How many explorable cells are seen from no place outside each region.
std::vector<double> groupCells(const std::vector<Witness>& witnesses,
                               const std::vector<std::int32_t>& owner) {
  std::vector<double> cells(
      static_cast<std::size_t>(std::max(kNobody, *std::max_element(owner.begin(), owner.end())) + 1), 0.0);
  for (const auto& witness : witnesses) {
    if (witness.seen_from.empty()) continue;
    const std::int32_t whose = owner[witness.seen_from.front()];
    if (whose != kNobody && std::all_of(witness.seen_from.begin(), witness.seen_from.end(),
                                        [&](std::uint32_t seer) { return owner[seer] == whose; }))
      cells[static_cast<std::size_t>(whose)] += witness.cells;
  }
  return cells;
}

/// King's moves within F from a set of cells to every cell.
std::vector<std::int32_t> movesFrom(const Floor& floor, std::vector<std::size_t> wave) {
  std::vector<std::int32_t> moves(floor.in.size(), std::numeric_limits<std::int32_t>::max());
  for (const std::size_t cell : wave) moves[cell] = 0;
  std::vector<std::size_t> next;
  for (std::int32_t move = 1; !wave.empty(); ++move, wave.swap(next)) {
    next.clear();
    for (const std::size_t cell : wave)
      floor.around(cell, [&](std::size_t to) {
        if (floor.in[to] && moves[to] > move) moves[to] = move, next.push_back(to);
      });
  }
  return moves;
}

Places placesOf(const Floor& floor, const std::vector<std::int32_t>& owner,
                const std::vector<double>& group_cells) {
  std::vector<std::size_t> chosen(group_cells.size());
  std::iota(chosen.begin(), chosen.end(), std::size_t{0});
  std::stable_sort(chosen.begin(), chosen.end(),
                   [&](std::size_t a, std::size_t b) { return group_cells[a] > group_cells[b]; });
  chosen.resize(std::min(chosen.size(), kMostGroups));
  std::vector<std::int32_t> place_of(group_cells.size(), kNobody);
  for (std::size_t k = 0; k < chosen.size(); ++k) place_of[chosen[k]] = static_cast<std::int32_t>(k);
  std::vector<std::vector<std::size_t>> region(chosen.size());
  for (std::size_t cell = 0; cell < owner.size(); ++cell)
    if (owner[cell] != kNobody && place_of[static_cast<std::size_t>(owner[cell])] != kNobody)
      region[static_cast<std::size_t>(place_of[static_cast<std::size_t>(owner[cell])])].push_back(cell);
  Places places;
  for (std::size_t k = 0; k < chosen.size(); ++k) {
    places.area.push_back(group_cells[chosen[k]]);
    const auto moves = movesFrom(floor, region[k]);
    std::vector<double> row(chosen.size(), std::numeric_limits<double>::infinity());
    const auto metres = [&](std::int32_t count) { return std::max(0, count - 1) * floor.plan.resolution_m; };
    for (std::size_t other = 0; other < chosen.size(); ++other) {
      std::int32_t least = std::numeric_limits<std::int32_t>::max();
      for (const std::size_t cell : region[other]) least = std::min(least, moves[cell]);
      row[other] = metres(least);
    }
    places.from_start.push_back(metres(moves[floor.start]));
    places.between.push_back(std::move(row));
  }
  return places;
}

/// The way to where the last of what may not be missed comes into sight.
double farthest(const std::vector<Witness>& witnesses, double spare_cells, double resolution_m) {
  std::vector<std::pair<std::int32_t, double>> by_moves;
  by_moves.reserve(witnesses.size());
  for (const auto& witness : witnesses) by_moves.emplace_back(-witness.moves, witness.cells);
  std::sort(by_moves.begin(), by_moves.end());
  double missed = 0;
  for (const auto& [moves, cells] : by_moves)
    if ((missed += cells) > spare_cells) return std::max(0, -moves - 1) * resolution_m;
  return 0;
}

}  // namespace

BoundBelow boundBelow(const world::Plan& plan, const metrics::ExplorableArea& area,
                      const core::Point2& start_world, double radius_m, double lidar_offset_m,
                      double max_range_m, const std::function<void()>& go_on) {
  BoundBelow best;
  if (area.cells == 0) return best;
  const Floor floor = floorOf(plan, start_world, radius_m);
  const int offset_cells =
      lidar_offset_m > 0 ? static_cast<int>(std::ceil(lidar_offset_m / plan.resolution_m)) + 1 : 0;
  Seers seers(floor, max_range_m > 0 ? max_range_m / plan.resolution_m : 0, offset_cells);
  const auto witnesses = witnessesOf(area, floor, seers, movesFrom(floor, {floor.start}), go_on);
  const auto cells = static_cast<double>(area.cells);
  best.below_90_m = farthest(witnesses, 0.10 * cells, plan.resolution_m);
  best.below_99_m = farthest(witnesses, 0.01 * cells, plan.resolution_m);
  for (const double grown : kGrownRegions) {
    const auto most = static_cast<std::size_t>(grown * static_cast<double>(floor.cells));
    const auto owner = regionsOf(witnesses, plan.cells.size(), most);
    const auto places = placesOf(floor, owner, groupCells(witnesses, owner));
    go_on();
    best.below_90_m = std::max(best.below_90_m, moatBound(places, 0.10 * cells));
    best.below_99_m = std::max(best.below_99_m, moatBound(places, 0.01 * cells));
  }
  return best;
}

}  // namespace slam::oracle
