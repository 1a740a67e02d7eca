#include "libslam/buildings/generator.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/buildings/generator/site.h"
#include "libslam/core/error.h"

namespace slam::buildings {
namespace {

constexpr double kMostCells = 1e8;  ///< 500 x 500 m at 0.05 m

struct Drawer {
  BuildingKind kind;
  void (*draw)(Site& site);
};

const std::vector<Drawer>& drawers() {
  static const std::vector<Drawer> all = {
      {{"flat", "one flat, or where there is room for more, flats along corridors", 13, 9.5, 1.5, 3.4},
       drawFlats},
      {{"office", "corridors with loops, rooms on both sides, cores, open plans, courtyards", 50, 32, 1.8,
        3.6},
       drawOffice},
      {{"hall", "a warehouse: racks in aisles, pallets, pillars, gates; large ones in sections", 50, 32, 2.8,
        60},
       drawHall},
      {{"hospital", "long symmetric corridors between rooms that look all the same, in wings", 60, 44, 2.4,
        3.8},
       drawHospital},
      {{"cave", "chambers and tunnels in rock: rough walls, loops, not one straight line", 50, 32, 1.6, 8},
       drawCave},
      {{"campus", "open air: yards between houses and their fronts, trees, lamp posts, parked cars", 120, 90,
        4, 50},
       drawCampus}};
  return all;
}

void transpose(world::Plan& plan) {
  const auto turn = [&plan](auto& raster) {
    auto turned = raster;
    for (size_t i = 0; i < raster.size(); ++i)
      turned[i % plan.columns * plan.rows + i / plan.columns] = raster[i];
    raster = std::move(turned);
  };
  turn(plan.cells);
  turn(plan.materials);
  for (world::Door& door : plan.doors) std::swap(door.x0, door.y0), std::swap(door.x1, door.y1);
  std::swap(plan.columns, plan.rows);
}

/// A door that a filled pocket has shut is none any more, and where a window was hollowed out there is no
/// glass.
void tidy(world::Plan& plan) {
  const auto isShut = [&plan](const world::Door& door) {
    for (int row = door.y0; row < door.y1; ++row)
      for (int column = door.x0; column < door.x1; ++column)
        if (plan.at(column, row) != world::Cell::kFree) return true;
    return false;
  };
  plan.doors.erase(std::remove_if(plan.doors.begin(), plan.doors.end(), isShut), plan.doors.end());
  for (size_t i = 0; i < plan.materials.size(); ++i)
    if (plan.cells[i] != world::Cell::kOccupied) plan.materials[i] = world::Material::kPlain;
  if (std::all_of(plan.materials.begin(), plan.materials.end(),
                  [](world::Material material) { return material == world::Material::kPlain; }))
    plan.materials.clear();
}

void requireSize(const char* key, double size_m) {
  if (size_m < 5 || size_m > 500)
    throw core::InputError("[building] " + std::string(key) + ": found " + files::formatNumber(size_m) +
                           ", expected 5 to 500, or 0 for the kind's own");
}

void requireCells(const BuildingOptions& o) {
  const double cells = o.width_m / o.resolution_m * (o.height_m / o.resolution_m);
  if (cells > kMostCells)
    throw core::InputError(
        "[building] resolution_m: found " + files::formatNumber(o.resolution_m) + " for " +
        files::formatNumber(o.width_m) + " x " + files::formatNumber(o.height_m) + " m, expected at least " +
        files::formatNumber(std::ceil(1e3 * std::sqrt(o.width_m * o.height_m / kMostCells)) / 1e3) +
        ": at most 100 million cells");
}

}  // namespace

const files::ParameterTable<BuildingOptions>& BuildingOptions::table() {
  using O = BuildingOptions;
  static const files::ParameterTable<O> rows(
      "building",
      {{"width_m", &O::width_m, 0.0, 0.0, 500.0, "outer width, 5 to 500; 0 = the kind's own"},
       {"height_m", &O::height_m, 0.0, 0.0, 500.0, "outer height, 5 to 500; 0 = the kind's own"},
       {"resolution_m", &O::resolution_m, 0.05, 0.02, 0.1, "side of a cell"},
       {"corridor_m", &O::corridor_m, 0.0, 0.0, 8.0,
        "clear width of corridors, aisles or tunnels, 1 to 8; 0 = the kind's own"},
       {"room_m", &O::room_m, 0.0, 0.0, 200.0,
        "usual length of a room along its corridor, of a hall's section or a campus's yard, between caves' "
        "chambers, 2.5 to 200; 0 = the kind's own"},
       {"pillars_m", &O::pillars_m, 0.0, 0.0, 80.0,
        "halls: open, with nothing but pillars so far apart and a few pieces; 0 = racks, pallets and "
        "machines"},
       {"door_m", &O::door_m, 0.9, 0.8, 2.0, "clear width of doors"},
       {"wall_m", &O::wall_m, 0.15, 0.1, 0.5, "thickness of inner walls"},
       {"outer_wall_m", &O::outer_wall_m, 0.3, 0.1, 1.0, "thickness of outer walls"},
       {"clutter", &O::clutter, 0.8, 0.0, 1.0, "share of the furniture that is there"},
       {"glass", &O::glass, 0.0, 0.0, 1.0, "share of the rooms with a front of glass"}});
  return rows;
}

const std::vector<BuildingKind>& buildingKinds() {
  static const std::vector<BuildingKind> kinds = [] {
    std::vector<BuildingKind> all;
    for (const Drawer& drawer : drawers()) all.push_back(drawer.kind);
    return all;
  }();
  return kinds;
}

GeneratedBuilding generateBuilding(const std::string& kind, const BuildingOptions& options,
                                   std::uint64_t seed) {
  const auto drawer = std::find_if(drawers().begin(), drawers().end(),
                                   [&kind](const Drawer& d) { return d.kind.name == kind; });
  if (drawer == drawers().end()) {
    std::vector<std::string> names;
    for (const BuildingKind& known : buildingKinds()) names.push_back(known.name);
    throw core::InputError("unknown kind of building '" + kind +
                           "', expected flat, office, hall, hospital, cave or campus" +
                           core::didYouMean(kind, names));
  }
  BuildingOptions o = options;
  const auto orOwn = [](double& value, double own) { value = value == 0 ? own : value; };
  orOwn(o.width_m, drawer->kind.width_m), orOwn(o.height_m, drawer->kind.height_m);
  orOwn(o.corridor_m, drawer->kind.corridor_m), orOwn(o.room_m, drawer->kind.room_m);
  requireSize("width_m", o.width_m), requireSize("height_m", o.height_m);
  requireCells(o);
  if (o.corridor_m < 1)
    throw core::InputError("[building] corridor_m: found " + files::formatNumber(o.corridor_m) +
                           ", expected 1 to 8, or 0 for the kind's own");
  if (o.room_m < 2.5)
    throw core::InputError("[building] room_m: found " + files::formatNumber(o.room_m) +
                           ", expected 2.5 to 200, or 0 for the kind's own");
  if (o.pillars_m > 0 && o.pillars_m < 3)
    throw core::InputError("[building] pillars_m: found " + files::formatNumber(o.pillars_m) +
                           ", expected 3 to 80, or 0 for a furnished hall");
  const bool stands = o.height_m > o.width_m;
  if (stands) std::swap(o.width_m, o.height_m);
  Site site(o, seed);
  drawer->draw(site);
  GeneratedBuilding building{site.canvas.plan(kind), static_cast<int>(site.rooms.size())};
  fillPockets(building.plan, kRobotRadius_m / o.resolution_m);
  tidy(building.plan);
  if (stands) transpose(building.plan);
  return building;
}

}  // namespace slam::buildings
