#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/files/parameters.h"
#include "libslam/world/plan.h"

namespace slam::check {

/// How bad a finding is: kError means that the plan cannot be used as it is.
enum class Severity { kNote, kWarning, kError };
std::string severityName(Severity severity);  ///< "note", "warning", "error"

/// What mending did to a cell.
enum class Change : std::uint8_t {
  kNone = 0,
  kRemoved = 1,  ///< was drawn there and is no wall: text, dimension lines, page border
  kAdded = 2,    ///< a wall that was too pale, or the edge of what is known
  kOpened = 3,   ///< a door
  kClosed = 4,   ///< a gap to the outside
  kHidden = 5    ///< free before, now unknown: outside, or out of the robot's reach
};

/// Where: pixels from the picture's upper left corner, and the same place in the world.
struct FindingPlace {
  int x = 0, y = 0;
  core::Point2 p_world;
};

struct Finding {
  std::string key;  ///< one of planCheckKeys()
  Severity severity = Severity::kNote;
  std::string text;    ///< what was found, with figures: one line
  std::string remedy;  ///< what mending does about it, or why it cannot
  bool is_mendable = false;
  int count = 0;                     ///< of the things found, where they can be counted
  std::vector<FindingPlace> places;  ///< some of them, the gravest first
};

/// Sizes of a plan, for a reader who knows the building.
struct PlanFigures {
  double width_m = 0, height_m = 0;  ///< of the box around the walls
  double free_m2 = 0;
  double reachable_m2 = 0;  ///< free area that the robot's body can cover from its start
  double free_share = 0, occupied_share = 0, unknown_share = 0;
  int rooms = 0;                      ///< spaces joined by passages that are clearly narrower than they are
  std::vector<double> door_widths_m;  ///< of these passages, ascending
  double megabytes = 0;               ///< of memory while simulating in it
};

/// How to look at a plan; section [check].
struct PlanCheckOptions {
  double robot_side_m;                  ///< of the square robot that has to pass
  double widest_gap_m;                  ///< gaps in the outline up to here are closed
  double least_room_m2;                 ///< a free area from here on counts as a room
  double door_m;                        ///< a usual door, for the scale
  double widest_spur_m;                 ///< what sticks out of the outer wall farther than this is no wall
  std::optional<double> resolution_m;   ///< given by the caller, over any yaml
  std::vector<std::string> only, skip;  ///< keys; empty `only`: all
  PlanCheckOptions();
  static const files::ParameterTable<PlanCheckOptions>& table();
};

/// The keys of all rules in the order in which they look, with what they look for.
struct PlanCheckKey {
  std::string key, meaning;
};
const std::vector<PlanCheckKey>& planCheckKeys();

struct PlanCheck {
  std::vector<Finding> findings;  ///< in the order of the keys
  world::Plan before;             ///< as loadPlan reads it
  world::Plan after;              ///< mended; the same cells where there is nothing to mend
  std::vector<Change> changes;    ///< as the cells of `after`
  PlanFigures figures;            ///< of `after`
  bool is_map = false;            ///< else a drawing
  /// Free space amid the walls that mending makes unknown (the paper around a drawing does not count), and
  /// its share in all of it. Much of it means that mending has taken rooms for the outside.
  double hidden_m2 = 0, hidden_share = 0;
  std::vector<std::string>
      files;  ///< that were read: the picture, or the yaml and the pictures that it names

  bool isUsable() const;    ///< no finding is an error
  bool isMendable() const;  ///< mending would change cells or write a scale
};

/// Looks a plan over, and mends a copy. Each rule looks at what the rules before it left, so that what is
/// said is what mending does. A second look at the mended plan finds nothing that could be mended.
///
/// A drawing (paper is free, down to the page's edge) is told from a map (the outside is unknown, as robots
/// and this toolkit write it): text, dimension lines, doors and page borders are looked for in drawings only,
/// unless their key is in `only`.
///
/// Errors: as loadPlan, but a plan without walls or without free space is a finding; an unknown key in only
/// or skip: InputError with the nearest known one.
PlanCheck checkPlan(const std::string& path, const PlanCheckOptions& options);

}  // namespace slam::check
