#include "libslam/buildings/building.h"

#include "libslam/buildings/drawn/buildings.h"
#include "libslam/core/error.h"

namespace slam::buildings {
namespace {

struct Building {
  const char* name;
  world::Plan (*make)(std::uint64_t seed);
};

constexpr Building kBuildings[] = {{"flat", makeFlat},
                                   {"office_loop", makeOfficeLoop},
                                   {"pillar_hall", makePillarHall},
                                   {"corridor", makeCorridor},
                                   {"maze", makeMaze}};

}  // namespace

std::vector<std::string> buildingNames() {
  std::vector<std::string> names;
  for (const auto& building : kBuildings) names.emplace_back(building.name);
  return names;
}

world::Plan makeBuilding(const std::string& name, std::uint64_t seed) {
  for (const auto& building : kBuildings)
    if (name == building.name) return building.make(seed);
  std::string known;
  for (const auto& building : kBuildings) known += (known.empty() ? "" : ", ") + std::string(building.name);
  throw core::InputError("unknown world '" + name + "', expected one of " + known +
                         core::didYouMean(name, buildingNames()));
}

}  // namespace slam::buildings
