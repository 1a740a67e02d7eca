#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/files/parameters.h"
#include "libslam/world/plan.h"

namespace slam::buildings {

/// Section [building]: what generateBuilding() draws. Where 0 stands for "the kind's own", buildingKinds()
/// has the value.
struct BuildingOptions {
  double width_m{}, height_m{};
  double resolution_m{};
  double corridor_m{}, room_m{}, door_m{};
  double pillars_m{};
  double wall_m{}, outer_wall_m{};
  double clutter{};
  double glass{};

  BuildingOptions() { table().setDefaults(*this); }
  static const files::ParameterTable<BuildingOptions>& table();
};

/// A kind of building, and what its options that are 0 mean.
struct BuildingKind {
  std::string name, meaning;
  double width_m, height_m, corridor_m, room_m;
};
/// "flat", "office", "hall", "hospital", "cave", "campus".
const std::vector<BuildingKind>& buildingKinds();

struct GeneratedBuilding {
  world::Plan plan;
  int rooms = 0;  ///< flats: their rooms; halls: their sections; caves: their chambers; a campus: its yards
};

/// Draws a building of any size from 5 to 500 m; a larger one has more rooms, not larger ones. Placed at the
/// origin.
///
/// Size: the plan has width_m by height_m, rounded to whole cells. One cell of unknown runs all round it,
/// then come the outer walls; a cave keeps away from them as it likes. What is higher than wide is drawn
/// lying and transposed. Nothing is drawn into shafts, courts and rock: they are unknown.
/// What holds for every kind, seed and size, for a robot of 0.25 m radius:
/// - a free cell has no unknown neighbour, also across a corner;
/// - all free cells are one 4-connected region, and so are the robot's admissible places (admissibleCells()):
///   what it cannot reach is filled;
/// - every one of Plan::doors is free, at least 0.8 m wide, and the robot reaches it and both its sides;
/// - findStartPose() finds a pose with 0.35 m around it.
/// Glass stands in Plan::materials, which is empty when there is none.
/// Chance: streams "building layout", "building doors", "building glass", and one per room and corridor net
/// for the furniture, so that other furniture or glass leaves the walls as they are. Integer arithmetic in
/// cells from the options on: the same cells on any machine.
/// Errors (InputError): unknown kind, with the nearest known one; a size outside 5 .. 500 m; more than 100
/// million cells; too small for the kind, with the least size. Cost: about 0.1 s and 15 MB per million cells
/// (a cave 0.2 s).
GeneratedBuilding generateBuilding(const std::string& kind, const BuildingOptions& options,
                                   std::uint64_t seed);

}  // namespace slam::buildings
