#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/buildings/drawn/canvas.h"
#include "libslam/buildings/generator.h"
#include "libslam/core/random.h"

namespace slam::buildings {

/// What a room is for; it decides the furniture.
enum class Use {
  kOffice,
  kMeeting,
  kOpenPlan,
  kLounge,
  kToilets,
  kStore,
  kStudio,
  kLiving,
  kKitchen,
  kBedroom,
  kBath,
  kFlatHall,
  kWard,
  kNurses,
  kWaiting,
  kCorridor
};

struct Room {
  Rect rect;
  Use use;
  Side front;  ///< the wall with its door
};

/// What every kind of building works with: the options in cells, a stream per concern, the canvas, the rooms
/// drawn so far. Lying: at least as wide as high.
struct Site {
  /// Options without zeros. REQUIRES width_m >= height_m.
  Site(const BuildingOptions& options, std::uint64_t seed);

  /// InputError saying the least size unless the rooms have at least this many cells inside the outer walls.
  void requireInside(const std::string& kind, int least_width, int least_height) const;

  int cells(int length_cm) const { return canvas.scale().cells(length_cm); }
  /// A doorway in the wall `front` of a room, beside it: `at` cells from the plan's west or south end.
  Rect doorway(const Rect& room, Side front, int at, int width) const;
  /// A doorway of a room somewhere between low and high along its front; in the middle when there is no
  /// choice. REQUIRES high - low >= door.
  void addDoor(const Rect& room, Side front, int low, int high);
  void addRoom(const Rect& rect, Use use, Side front);
  /// Carves the room too.
  void carveRoom(const Rect& rect, Use use, Side front);
  /// Makes the inner front wall of some rooms of glass, by the option's share. After the walls were raised.
  void glaze();
  /// Hollows a window out of every wall of a room to the outside or a court, half as long as it. After
  /// furniture, which keeps to the wall.
  void addWindows();

  BuildingOptions options;
  std::uint64_t seed;
  core::RandomStream layout, doors;
  Canvas canvas;
  int width, height;  ///< inside the outer walls
  int wall, outer_wall, corridor, door;
  int room;     ///< the usual length of a room along its corridor
  int pillars;  ///< between an open hall's pillars; 0: the hall is furnished
  int nook;     ///< least wall beside a door
  std::vector<Room> rooms;
  std::vector<Rect> courts;  ///< open air inside the building: never carved
};

/// The robot for whom all is made.
inline constexpr double kRobotRadius_m = 0.25;

/// Fills what a robot of that radius cannot reach: free cells around admissible places outside their largest
/// region, and then the free cells without a connection to it. Until none is left.
void fillPockets(world::Plan& plan, double radius_cells);

// One file each. Each draws the whole building on the site and returns it; too small: InputError.
void drawFlats(Site& site);
void drawOffice(Site& site);
void drawHall(Site& site);
void drawHospital(Site& site);
void drawCave(Site& site);
void drawCampus(Site& site);

}  // namespace slam::buildings
