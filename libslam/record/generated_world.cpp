#include "libslam/record/generated_world.h"

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/world/building.h"

namespace slam::record {

world::GeneratedBuilding generateWorld(const std::string& kind, const core::IniFile& config,
                                       std::uint64_t seed) {
  world::BuildingOptions options;
  core::readParameters(config, world::BuildingOptions::table(), options);
  const auto& kinds = world::buildingKinds();
  const bool is_kind = std::any_of(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == kind; });
  const auto fixed = world::buildingNames();
  if (is_kind || std::find(fixed.begin(), fixed.end(), kind) == fixed.end())
    return world::generateBuilding(kind, options, seed);
  if (config.hasSection("building"))
    throw core::InputError("'" + kind + "' has one size and no options, expected only a seed");
  return {world::makeBuilding(kind, seed), 0};
}

}  // namespace slam::record
