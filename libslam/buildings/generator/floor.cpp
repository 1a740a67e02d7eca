#include "libslam/buildings/generator/floor.h"

#include <algorithm>

namespace slam::buildings {
namespace {

/// `total` in `count` parts that differ by chance by up to a tenth of their size.
std::vector<int> share(core::RandomStream& random, int total, int count) {
  std::vector<int> parts(static_cast<size_t>(count), total / count);
  for (int i = 0; i < total % count; ++i) ++parts[i];
  const int most = total / count / 10;
  for (int i = 0; i + 1 < count; i += 2) {
    const int shift = pick(random, -most, most);
    parts[i] += shift, parts[i + 1] -= shift;
  }
  return parts;
}

Floor layOneCorridor(Site& site, const FloorPlan& plan) {
  const int c = site.corridor, w = site.wall, spare = site.height - c;
  Floor floor;
  const bool is_double = spare >= 2 * (plan.least_depth + w);
  const int south = is_double ? share(site.layout, spare - 2 * w, 2)[0] : -w;
  const Rect corridor{0, south + w, site.width, south + w + c};
  floor.corridors.push_back(corridor);
  if (is_double) floor.rows.push_back({{0, 0, site.width, south}, Side::kNorth, 0, site.width});
  floor.rows.push_back({{0, corridor.y1 + w, site.width, site.height}, Side::kSouth, 0, site.width});
  return floor;
}

Floor layNet(Site& site, const FloorPlan& plan, int count) {
  const int c = site.corridor, w = site.wall, strip = c + 2 * w;
  // Depths from south to north: an outer row, two to each block, an outer row.
  const std::vector<int> depths =
      share(site.layout, site.height - count * strip - (count - 1) * plan.between, 2 * count);
  const int spare = (site.width - 2 * strip - plan.least_block) / 2;
  const bool has_ends = spare >= plan.least_depth;
  const int usual = std::min(spare, depths.front());
  const int west = has_ends ? std::max(plan.least_depth, usual - pick(site.layout, 0, usual / 10)) : -w;
  const int east = has_ends ? std::max(plan.least_depth, usual - pick(site.layout, 0, usual / 10)) : -w;
  const int x0 = west + w, x1 = site.width - east - w;

  Floor floor;
  std::vector<int> ys;  // of the long corridors
  int y = depths.front() + w;
  for (int k = 0; k < count; ++k) {
    ys.push_back(y);
    floor.corridors.push_back({x0, y, x1, y + c});
    if (k + 1 < count) y += c + w + depths[2 * k + 1] + plan.between + depths[2 * k + 2] + w;
  }
  const int y0 = ys.front(), y1 = ys.back() + c;
  floor.corridors.push_back({x0, y0, x0 + c, y1});
  floor.corridors.push_back({x1 - c, y0, x1, y1});

  floor.rows.push_back({{0, 0, site.width, depths.front()}, Side::kNorth, x0, x1});
  floor.rows.push_back({{0, y1 + w, site.width, site.height}, Side::kSouth, x0, x1});
  if (has_ends) {
    floor.rows.push_back({{0, y0, west, y1}, Side::kEast, y0, y1});
    floor.rows.push_back({{site.width - east, y0, site.width, y1}, Side::kWest, y0, y1});
  }
  const int begin = x0 + c + w;
  for (int k = 0; k + 1 < count; ++k) {
    const auto blocks = partition(site.layout, x1 - c - w - begin, plan.least_block, plan.most_block, strip);
    for (const auto& [from, to] : blocks) {
      floor.blocks.push_back({{begin + from, ys[k] + c + w, begin + to, ys[k + 1] - w}});
      if (begin + to + strip < x1 - c)
        floor.corridors.push_back({begin + to + w, ys[k], begin + to + w + c, ys[k + 1] + c});
    }
  }
  return floor;
}

}  // namespace

Floor layFloor(Site& site, const std::string& kind, const FloorPlan& plan) {
  const int w = site.wall, strip = site.corridor + 2 * w;
  site.requireInside(kind, plan.least_room, site.corridor + w + plan.least_depth);
  const int pitch = strip + 2 * plan.depth + plan.between;
  int count = std::max(1, (site.height + plan.between + pitch / 2) / pitch);
  // share() takes up to a tenth off a row.
  while (count > 1 && site.height - count * strip - (count - 1) * plan.between <
                          2 * count * plan.least_depth * 10 / 9 + count)
    --count;
  if (site.width < 2 * strip + plan.least_block + 2 * plan.least_room) count = 1;
  Floor floor = count == 1 ? layOneCorridor(site, plan) : layNet(site, plan, count);
  for (const Rect& corridor : floor.corridors) site.canvas.carve(corridor);
  return floor;
}

std::vector<RowRoom> cutRow(Site& site, const Row& row, int least, int most) {
  const bool runs_in_x = row.front == Side::kNorth || row.front == Side::kSouth;
  const int begin = runs_in_x ? row.rect.x0 : row.rect.y0, end = runs_in_x ? row.rect.x1 : row.rect.y1;
  const auto cuts = partition(site.layout, row.high - row.low, least, most, site.wall);
  std::vector<RowRoom> rooms;
  for (size_t i = 0; i < cuts.size(); ++i) {
    const int low = row.low + cuts[i].first, high = row.low + cuts[i].second;
    const int from = i == 0 ? begin : low, to = i + 1 == cuts.size() ? end : high;
    rooms.push_back(
        {runs_in_x ? Rect{from, row.rect.y0, to, row.rect.y1} : Rect{row.rect.x0, from, row.rect.x1, to}, low,
         high});
  }
  return rooms;
}

std::vector<Row> rowsOf(Site& site, const Rect& block, int least_depth, int between) {
  const int spare = block.height() - between;
  if (spare < 2 * least_depth)
    return {{block, site.layout.below(2) == 0 ? Side::kNorth : Side::kSouth, block.x0, block.x1}};
  const int south = std::max(least_depth, share(site.layout, spare, 2)[0]);
  const int cut = block.y0 + std::min(south, spare - least_depth);
  if (between > site.wall) site.courts.push_back({block.x0, cut, block.x1, cut + between});
  return {{{block.x0, block.y0, block.x1, cut}, Side::kSouth, block.x0, block.x1},
          {{block.x0, cut + between, block.x1, block.y1}, Side::kNorth, block.x0, block.x1}};
}

Side opposite(Side side) {
  switch (side) {
    case Side::kWest:
      return Side::kEast;
    case Side::kEast:
      return Side::kWest;
    case Side::kSouth:
      return Side::kNorth;
    default:
      return Side::kSouth;
  }
}

}  // namespace slam::buildings
