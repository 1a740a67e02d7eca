#pragma once
#include <cstdint>
#include <string>

#include "libslam/buildings/generator.h"
#include "libslam/files/ini.h"

namespace slam::record {

/// Draws what `rasterslam world make KIND` draws: one of buildings::buildingKinds() with section [building]
/// of the configuration, or one of buildings::buildingNames(), whose size is fixed, which takes only a seed.
/// Errors: InputError (unknown kind or key, impossible size, options for a fixed one).
buildings::GeneratedBuilding generateWorld(const std::string& kind, const files::IniFile& config,
                                           std::uint64_t seed);

}  // namespace slam::record
