#pragma once
#include <mrpt/maps/CSimpleMap.h>

#include <string>

namespace slam::mapping {

/// An MRPT simplemap. Errors: InputError for a file that is none, or holds no scan.
mrpt::maps::CSimpleMap loadSimpleMap(const std::string& path);

}  // namespace slam::mapping
