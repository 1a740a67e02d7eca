#include "libslam/record/generated_world.h"

#include <algorithm>

#include "libslam/buildings/building.h"
#include "libslam/core/error.h"

namespace slam::record {

buildings::GeneratedBuilding generateWorld(const std::string& kind, const files::IniFile& config,
                                           std::uint64_t seed) {
  buildings::BuildingOptions options;
  files::readParameters(config, buildings::BuildingOptions::table(), options);
  const auto& kinds = buildings::buildingKinds();
  const bool is_kind = std::any_of(kinds.begin(), kinds.end(), [&](const auto& k) { return k.name == kind; });
  const auto fixed = buildings::buildingNames();
  if (is_kind || std::find(fixed.begin(), fixed.end(), kind) == fixed.end())
    return buildings::generateBuilding(kind, options, seed);
  if (config.hasSection("building"))
    throw core::InputError("'" + kind + "' has one size and no options, expected only a seed");
  return {buildings::makeBuilding(kind, seed), 0};
}

}  // namespace slam::record
