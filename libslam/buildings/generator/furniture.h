#pragma once
#include "libslam/buildings/generator/site.h"

namespace slam::buildings {

/// Puts into every room what its use asks for, by the share that the option `clutter` gives, where it leaves
/// every way open. After the walls were raised. Each room has a stream of its own.
void furnish(Site& site);

/// A piece `size_x` by `size_y` centred in the room, chairs on its long sides; nothing where it would close a
/// way.
void placeTable(Site& site, const Rect& room, int length_cm, int depth_cm);

}  // namespace slam::buildings
