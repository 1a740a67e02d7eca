#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/world/plan.h"

namespace slam::buildings {

/// Names of the committed worlds: "flat", "office_loop", "pillar_hall", "corridor", "maze".
std::vector<std::string> buildingNames();

/// Draws a world at 0.05 m: rooms with doors wide enough for the robot, furniture, walls of several cells,
/// everything enclosed, unknown outside, and every free place within reach of a robot of 0.2 m radius.
/// Integer arithmetic only, so the same name and seed give the same cells on any machine; other seeds move
/// furniture, doors and rooms. One file per building in buildings/; the committed pictures in datasets/worlds
/// are of seed
/// 1. Unknown name: InputError with the nearest known one.
world::Plan makeBuilding(const std::string& name, std::uint64_t seed);

}  // namespace slam::buildings
