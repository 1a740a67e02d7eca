#include "libslam/world/building.h"

#include "libslam/core/error.h"
#include "libslam/world/buildings/buildings.h"

namespace slam::world {
namespace {

struct Building {
  const char* name;
  Plan (*make)(std::uint64_t seed);
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

Plan makeBuilding(const std::string& name, std::uint64_t seed) {
  for (const auto& building : kBuildings)
    if (name == building.name) return building.make(seed);
  std::string known;
  for (const auto& building : kBuildings) known += (known.empty() ? "" : ", ") + std::string(building.name);
  throw core::InputError("unknown world '" + name + "', expected one of " + known +
                         core::didYouMean(name, buildingNames()));
}

}  // namespace slam::world
