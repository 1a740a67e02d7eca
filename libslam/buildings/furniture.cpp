#include "libslam/buildings/furniture.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libslam/core/random.h"

namespace slam::buildings {
namespace {

constexpr int kDraws = 30;
constexpr double kThin_m = 0.25, kLongLine_m = 1.0;
constexpr double kLeg_m = 0.15, kBetweenLegs_m = 1.3;
constexpr double kAround_m = 1.0;  // ways round a piece that lie within this beside it count as staying open

struct Box {
  int x0, y0, x1, y1;

  void add(int x, int y) {
    x0 = std::min(x0, x), y0 = std::min(y0, y), x1 = std::max(x1, x + 1), y1 = std::max(y1, y + 1);
  }
  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
};

/// A piece of furniture: its cells, counted from its box's corner.
struct Piece {
  struct Part {
    int x, y;
    world::Material material;
  };
  Box box;
  std::vector<Part> parts;
};

size_t indexOf(const world::Plan& plan, int x, int y) {
  return static_cast<size_t>(y) * static_cast<size_t>(plan.columns) + static_cast<size_t>(x);
}

int cellsIn(double metres, const world::Plan& plan) {
  return static_cast<int>(std::ceil(metres / plan.resolution_m));
}

int longerSide(const Box& box) {
  return std::max(box.width(), box.height());
}

bool isFurniture(const world::Plan& plan, const Box& box, const FurnitureRules& rules) {
  if (box.x0 == 0 || box.y0 == 0 || box.x1 == plan.columns || box.y1 == plan.rows) return false;
  const double longer_m = longerSide(box) * plan.resolution_m,
               shorter_m = std::min(box.width(), box.height()) * plan.resolution_m;
  const bool is_line = shorter_m <= kThin_m && longer_m >= kLongLine_m;
  return longer_m <= rules.largest_m && !is_line;
}

/// One piece of two, their parts counted from the common box.
Piece joined(const Piece& a, const Piece& b) {
  Piece result{a.box, {}};
  result.box.add(b.box.x0, b.box.y0);
  result.box.add(b.box.x1 - 1, b.box.y1 - 1);
  for (const Piece* piece : {&a, &b})
    for (const auto& part : piece->parts)
      result.parts.push_back(
          {piece->box.x0 + part.x - result.box.x0, piece->box.y0 + part.y - result.box.y0, part.material});
  return result;
}

/// Legs go with their table: small pieces near each other are one, as long as that is no larger than
/// furniture is.
std::vector<Piece> withJoinedLegs(const std::vector<Piece>& pieces, const world::Plan& plan,
                                  const FurnitureRules& rules) {
  const double leg = kLeg_m / plan.resolution_m, between = kBetweenLegs_m / plan.resolution_m;
  const auto isLeg = [&](const Piece& piece) { return longerSide(piece.box) <= leg + 1e-9; };
  std::vector<Piece> result, tables;
  for (const auto& piece : pieces) {
    if (!isLeg(piece)) {
      result.push_back(piece);
      continue;
    }
    const auto table = std::find_if(tables.begin(), tables.end(), [&](const Piece& legs) {
      const int dx = std::max(legs.box.x0 - piece.box.x1, piece.box.x0 - legs.box.x1),
                dy = std::max(legs.box.y0 - piece.box.y1, piece.box.y0 - legs.box.y1);
      return std::max(dx, dy) <= between &&
             longerSide(joined(legs, piece).box) * plan.resolution_m <= rules.largest_m;
    });
    if (table == tables.end())
      tables.push_back(piece);
    else
      *table = joined(*table, piece);
  }
  result.insert(result.end(), tables.begin(), tables.end());
  return result;
}

std::vector<Piece> findFurniture(const world::Plan& plan, const FurnitureRules& rules) {
  std::vector<Piece> pieces;
  std::vector<char> is_left(plan.cells.size());
  std::transform(plan.cells.begin(), plan.cells.end(), is_left.begin(),
                 [](world::Cell cell) { return cell == world::Cell::kOccupied; });
  std::vector<size_t> cells;
  for (size_t first = 0; first < is_left.size(); ++first) {
    if (!is_left[first]) continue;
    cells.assign(1, first);
    is_left[first] = 0;
    Box box{plan.columns, plan.rows, 0, 0};
    for (size_t done = 0; done < cells.size(); ++done) {
      const int x = static_cast<int>(cells[done] % static_cast<size_t>(plan.columns)),
                y = static_cast<int>(cells[done] / static_cast<size_t>(plan.columns));
      box.add(x, y);
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          if (!plan.contains(x + dx, y + dy)) continue;
          const size_t next = indexOf(plan, x + dx, y + dy);
          if (is_left[next]) is_left[next] = 0, cells.push_back(next);
        }
    }
    if (!isFurniture(plan, box, rules)) continue;
    Piece piece{box, {}};
    for (const size_t cell : cells)
      piece.parts.push_back({static_cast<int>(cell % static_cast<size_t>(plan.columns)) - box.x0,
                             static_cast<int>(cell / static_cast<size_t>(plan.columns)) - box.y0,
                             plan.materials.empty() ? world::Material::kPlain : plan.materials[cell]});
    pieces.push_back(std::move(piece));
  }
  return withJoinedLegs(pieces, plan, rules);
}

/// A quarter turn counter-clockwise within its own box.
Piece turned(const Piece& piece) {
  Piece result;
  result.box = {piece.box.x0, piece.box.y0, piece.box.x0 + piece.box.height(),
                piece.box.y0 + piece.box.width()};
  for (const auto& part : piece.parts)
    result.parts.push_back({piece.box.height() - 1 - part.y, part.x, part.material});
  return result;
}

void put(const Piece& piece, bool stands, world::Plan& plan) {
  for (const auto& part : piece.parts) {
    const size_t cell = indexOf(plan, piece.box.x0 + part.x, piece.box.y0 + part.y);
    plan.cells[cell] = stands ? world::Cell::kOccupied : world::Cell::kFree;
    if (!plan.materials.empty()) plan.materials[cell] = stands ? part.material : world::Material::kPlain;
  }
}

bool fits(const Piece& piece, const world::Plan& plan, double clearance_m) {
  for (const auto& part : piece.parts) {
    const int x = piece.box.x0 + part.x, y = piece.box.y0 + part.y;
    if (!plan.contains(x, y) || plan.at(x, y) != world::Cell::kFree) return false;
  }
  const int keep = cellsIn(clearance_m, plan);
  return std::none_of(plan.doors.begin(), plan.doors.end(), [&](const world::Door& door) {
    return piece.box.x0 < door.x1 + keep && door.x0 - keep < piece.box.x1 && piece.box.y0 < door.y1 + keep &&
           door.y0 - keep < piece.box.y1;
  });
}

/// Which cells of a window belong together: 0 where one cannot be, else the number of the 4-connected part.
std::vector<int> partsOf(std::vector<char> is_way, int width) {
  std::vector<int> labels(is_way.size(), 0);
  std::vector<size_t> cells;
  const auto columns = static_cast<size_t>(width);
  int label = 0;
  for (size_t first = 0; first < is_way.size(); ++first) {
    if (!is_way[first]) continue;
    cells.assign(1, first);
    is_way[first] = 0;
    labels[first] = ++label;
    for (size_t done = 0; done < cells.size(); ++done) {
      const size_t cell = cells[done];
      const auto add = [&](bool exists, size_t next) {
        if (!exists || !is_way[next]) return;
        is_way[next] = 0;
        labels[next] = label;
        cells.push_back(next);
      };
      add(cell % columns > 0, cell - 1);
      add(cell % columns + 1 < columns, cell + 1);
      add(cell >= columns, cell - columns);
      add(cell + columns < is_way.size(), cell + columns);
    }
  }
  return labels;
}

/// Where in the window a disc may be; radius 0 asks for the cell alone.
std::vector<char> waysIn(const world::Plan& plan, const Box& window, double radius_m) {
  const int reach = radius_m > 0 ? cellsIn(radius_m, plan) : 0;
  const double radius = radius_m / plan.resolution_m;
  std::vector<char> ways(static_cast<size_t>(window.width()) * static_cast<size_t>(window.height()), 1);
  for (int y = window.y0 - reach; y < window.y1 + reach; ++y)
    for (int x = window.x0 - reach; x < window.x1 + reach; ++x) {
      if (plan.contains(x, y) && plan.at(x, y) != world::Cell::kOccupied) continue;
      for (int cy = std::max(window.y0, y - reach); cy < std::min(window.y1, y + reach + 1); ++cy)
        for (int cx = std::max(window.x0, x - reach); cx < std::min(window.x1, x + reach + 1); ++cx) {
          const double gap_x = std::max(0.0, std::abs(cx - x) - 0.5),
                       gap_y = std::max(0.0, std::abs(cy - y) - 0.5);
          if (gap_x * gap_x + gap_y * gap_y <= radius * radius)
            ways[static_cast<size_t>(cy - window.y0) * static_cast<size_t>(window.width()) +
                 static_cast<size_t>(cx - window.x0)] = 0;
        }
    }
  return ways;
}

/// True when what was one part and is still a way is one part still. What happens beyond the window passes
/// through its rim, and there the parts are the same: so nothing is cut off in the whole plan either.
bool staysConnected(const std::vector<int>& before, const std::vector<int>& after) {
  std::vector<int> now(before.size() + 1, 0);
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i] == 0 || after[i] == 0) continue;
    int& label = now[static_cast<size_t>(before[i])];
    if (label == 0) label = after[i];
    if (label != after[i]) return false;
  }
  return true;
}

bool keepsWaysOpen(const world::Plan& before, const world::Plan& after, const Piece& from, const Piece& to,
                   double clearance_m) {
  const int margin = cellsIn(2 * clearance_m + kAround_m, before);
  const Box window{std::max(0, std::min(from.box.x0, to.box.x0) - margin),
                   std::max(0, std::min(from.box.y0, to.box.y0) - margin),
                   std::min(before.columns, std::max(from.box.x1, to.box.x1) + margin),
                   std::min(before.rows, std::max(from.box.y1, to.box.y1) + margin)};
  for (const double radius_m : {0.0, clearance_m})
    if (!staysConnected(partsOf(waysIn(before, window, radius_m), window.width()),
                        partsOf(waysIn(after, window, radius_m), window.width())))
      return false;
  return true;
}

/// Nothing is carried through a wall: the straight line between the middles is free of what stands.
bool isCarriedFreely(const world::Plan& plan, const Box& from, const Box& to) {
  const int dx = to.x0 + to.x1 - from.x0 - from.x1, dy = to.y0 + to.y1 - from.y0 - from.y1;
  const int steps = std::max({1, std::abs(dx), std::abs(dy)});
  for (int i = 0; i <= steps; ++i) {
    // In quarters of a cell, so that whole numbers decide.
    const int x = (2 * (from.x0 + from.x1) * steps + 2 * dx * i) / (4 * steps),
              y = (2 * (from.y0 + from.y1) * steps + 2 * dy * i) / (4 * steps);
    if (plan.contains(x, y) && plan.at(x, y) == world::Cell::kOccupied) return false;
  }
  return true;
}

/// Both plans hold the piece where it stands; true when they then hold it somewhere else.
bool moveElsewhere(const Piece& piece, const FurnitureRules& rules, core::RandomStream& random,
                   world::Plan& before, world::Plan& after) {
  const int farthest = static_cast<int>(rules.farthest_m / before.resolution_m);
  put(piece, false, after);
  for (int draw = 0; draw < kDraws; ++draw) {
    Piece moved = piece;
    for (std::uint64_t turns = random.below(4); turns > 0; --turns) moved = turned(moved);
    const auto shift = [&] {
      return static_cast<int>(random.below(2 * static_cast<std::uint64_t>(farthest) + 1)) - farthest;
    };
    const int dx = shift(), dy = shift();
    if (dx == 0 && dy == 0) continue;
    moved.box = {moved.box.x0 + dx, moved.box.y0 + dy, moved.box.x1 + dx, moved.box.y1 + dy};
    if (!fits(moved, after, rules.clearance_m) || !isCarriedFreely(after, piece.box, moved.box)) continue;
    put(moved, true, after);
    if (keepsWaysOpen(before, after, piece, moved, rules.clearance_m)) {
      put(piece, false, before);
      put(moved, true, before);
      return true;
    }
    put(moved, false, after);
  }
  put(piece, true, after);
  return false;
}

}  // namespace

MovedFurniture moveFurniture(const world::Plan& plan, std::uint64_t seed, double share,
                             const FurnitureRules& rules) {
  core::RandomStream random(seed, "furniture");
  MovedFurniture result;
  result.plan = plan;
  const auto pieces = findFurniture(plan, rules);
  result.pieces = static_cast<int>(pieces.size());
  world::Plan before = plan;
  for (const auto& piece : pieces)
    if (random.chance(share) && moveElsewhere(piece, rules, random, before, result.plan)) ++result.moved;
  return result;
}

}  // namespace slam::buildings
