#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/world/cell_map.h"

namespace slam::world {

/// What an occupied cell is made of, for sensors that care.
enum class Material : std::uint8_t { kPlain = 0, kGlass = 1, kMirror = 2, kDark = 3 };

/// A doorway that can be shut: cells x0 .. x1-1 by y0 .. y1-1, all free while the door is open.
struct Door {
  int x0, y0, x1, y1;
};

/// The true world, placed in the world frame; an estimated map is a CellMap and no Plan. Where only cells
/// count (rays, pictures, scores) both are taken as CellMaps.
struct Plan : CellMap {
  std::vector<Material> materials;  ///< as cells, or empty: all plain; free cells are plain
  std::vector<Door> doors;
};

/// How a picture becomes a plan. From a ROS yaml where there is one.
struct PlanOptions {
  double resolution_m = 0.05;
  core::Pose2 T_frame_raster;
  bool negate = false;
  double occupied_threshold = 0.65;  ///< occupied when (255 - gray) / 255 is above (ROS map_server's rule)
  double free_threshold = 0.196;     ///< free when below; between the two unknown
  bool allow_empty = false;          ///< accept a picture without walls or without free space
};

/// Reads a plan: a ROS map yaml (by its suffix; image, resolution, origin, negate, thresholds, mode
/// trinary/scale/raw, and ours: materials, see materials_file.h; of `options` only allow_empty counts), or a
/// picture bmp, png, pgm, jpg with `options`.
///
/// Gray is the mean of the colours, 8 or 16 bits. A bare picture with an alpha channel that is not opaque
/// everywhere follows the original raster lidar: alpha at its maximum is an obstacle, anything less is free,
/// whatever the colour; an opaque picture goes by gray level. The alpha of 32-bit BMPs counts unless it is 0
/// everywhere. In a ROS map pixels that are not opaque are unknown. mode scale is read as trinary (what lies
/// between the thresholds is unknown either way); mode raw takes the 8-bit pixel as the occupancy in percent,
/// above 100 unknown, and ignores negate.
///
/// Errors (InputError, one line with path and key): missing, a folder, truncated or not a picture, yaml that
/// names a missing picture, materials that readMaterials() refuses, a door outside the plan or over a cell
/// that is not free, unknown or duplicate key, key missing / malformed / out of range, no obstacle at
/// all, no free cell at all, more than 2^28 cells or 2^15 on a side (the reach of castRay's proof).
Plan loadPlan(const std::string& path, const PlanOptions& options = {});

/// Writes a picture beside the yaml (NAME.yaml, NAME.png; 254 free, 0 occupied, 205 unknown) and the ROS yaml
/// that loads it back to the same cells, resolution, placement, materials and doors, bit for bit; a plan with
/// materials has NAME.materials.png too. All or none are written. Errors: IoError.
void savePlan(const Plan& plan, const std::string& yaml_path);

/// True when a disc around p_world touches the square of an occupied cell (equality counts) or leaves the
/// plan; also when p_world is not finite. Unknown cells are no obstacle. Cost: the cells under the disc.
bool discCollides(const Plan& plan, const core::Point2& p_world, double radius_m);

/// A start pose with `clearance_m` all round. Admissible are the free cells at whose centre a disc of that
/// radius does not collide; in their largest 4-connected region (so it counts what a robot can reach from
/// there, not what it sees) the one nearest to the region's centre of mass, of equals the lowest and then
/// leftmost; heading 0 in the world. nullopt when there is none. In start_pose.cpp.
std::optional<core::Pose2> findStartPose(const Plan& plan, double clearance_m);

}  // namespace slam::world
