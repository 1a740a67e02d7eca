#pragma once
#include <cstdint>
#include <string>

#include "libslam/core/ini.h"
#include "libslam/world/generator.h"

namespace slam::record {

/// Draws what `rasterslam world make KIND` draws: one of world::buildingKinds() with section [building] of the
/// configuration, or one of world::buildingNames(), whose size is fixed, which takes only a seed. Errors: InputError
/// (unknown kind or key, impossible size, options for a fixed one).
world::GeneratedBuilding generateWorld(const std::string& kind, const core::IniFile& config,
                                       std::uint64_t seed);

}  // namespace slam::record
