#pragma once
#include <cstdint>

#include "libslam/world/plan.h"

namespace slam::buildings {

/// 12 x 9 m: living room, kitchen, bath, three rooms and a hall; one loop through living room, kitchen, hall.
world::Plan makeFlat(std::uint64_t seed);
/// 40 x 25 m: offices around a ring corridor, a core with meeting rooms and a lounge that crosses it.
world::Plan makeOfficeLoop(std::uint64_t seed);
/// 25 x 20 m: a hall with pillars, racks and pallets.
world::Plan makePillarHall(std::uint64_t seed);
/// 60 m long, 2.4 m wide, hardly a feature between a lobby at each end.
world::Plan makeCorridor(std::uint64_t seed);
/// 16 x 16 m: passages of 1.3 m, a few loops.
world::Plan makeMaze(std::uint64_t seed);

}  // namespace slam::buildings
