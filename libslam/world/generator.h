#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/parameters.h"
#include "libslam/world/plan.h"

namespace slam::world {

/// Section [building]: what generateBuilding() draws. Where 0 stands for "the kind's own", buildingKinds() has
/// the value.
struct BuildingOptions {
  double width_m, height_m;
  double resolution_m;
  double corridor_m, room_m, door_m;
  double wall_m, outer_wall_m;
  double clutter;
  double glass;

  BuildingOptions() { table().setDefaults(*this); }
  static const core::ParameterTable<BuildingOptions>& table();
};

/// A kind of building, and what its options that are 0 mean.
struct BuildingKind {
  std::string name, meaning;
  double width_m, height_m, corridor_m, room_m;
};
/// "flat", "office", "hall", "hospital", "cave".
const std::vector<BuildingKind>& buildingKinds();

struct GeneratedBuilding {
  Plan plan;
  int rooms = 0;  ///< flats: their rooms; halls: their sections; caves: their chambers
};

/// Draws a building of any size from 5 to 200 m; a larger one has more rooms, not larger ones.
///
/// Size: the picture has width_m by height_m, rounded to whole cells, with one cell of unknown all round and
/// the outer walls next to it; rock fills what a cave leaves. All that is higher than wide is drawn lying and
/// then transposed. Placed at the origin.
/// What holds for every kind, seed and size: no free cell borders on unknown; all free cells are one 4-connected
/// region; so are the admissible places of a robot of 0.25 m radius (admissibleCells()), for what it cannot reach
/// is filled; every one of Plan::doors is at least 0.8 m wide, free and reached by it; findStartPose() finds a
/// pose with 0.35 m around it. Glass stands in Plan::materials, which is empty when there is none.
/// Chance: streams "building layout", "building doors", "building glass" and one per room for its furniture, so
/// other furniture or glass leaves the walls as they are. Integer arithmetic in cells from the options on:
/// the same cells on any machine.
/// Errors (InputError): unknown kind, with the nearest known one; a size outside 5 .. 200 m; too small for the
/// kind, with the least size. Cost: about 0.1 s per million cells.
GeneratedBuilding generateBuilding(const std::string& kind, const BuildingOptions& options,
                                   std::uint64_t seed);

}  // namespace slam::world
