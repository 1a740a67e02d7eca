#pragma once
#include <optional>

#include "libslam/core/pose2.h"
#include "libslam/world/plan.h"

namespace slam::rays {

/// The first wall on a ray, and what it is.
struct WallHit {
  double distance_m;  ///< as castRay()
  /// To where the ray leaves this wall: the first cell that is free, unknown or of another material;
  /// +infinity when the plan ends before.
  double leaves_m;
  int column, row;  ///< the occupied cell
  int face_x,
      face_y;  ///< outward normal of the face that it is entered by, plan axes; 0, 0: origin in the wall
  world::Material material;
};

/// nullopt where castRay() without a limit gives infinity. Cost: as castRay().
std::optional<WallHit> findWall(const world::Plan& plan, const core::Point2& origin_world, double angle_rad);

/// True when no wall within a thousandth of a cell of a point is of another material than plain: then a ray
/// that ends there met a plain wall or none, and findWall() need not be asked.
bool isPlainAt(const world::Plan& plan, const core::Point2& p_world);

/// What plane the raster's faces around a hit stand for.
struct Surface {
  core::Point2 normal;  ///< unit vector in the world frame, on the side of the face that was hit
  double steps_m;       ///< how far the raster's steps may stand out of the plane; 0 along the plan's axes
};

/// From the contour of the wall: the chain of faces of the same material through the one that was hit, up to
/// 40 faces either way, is cut where it turns back or turns a corner, which is where two runs of more than
/// one face meet; what is left is the staircase of a straight line. Its first and last step give the
/// direction; a lone step that of the two half runs beside it; no step an axis.
///
/// Exact for walls along the plan's axes, also beside corners, ends and other materials, and for slopes 1 : n
/// of which two steps are in reach; for other straight walls off by at most one cell over the steps in reach,
/// less than a degree. A curved wall gets its chord. An edge one cell wide is no staircase: its own face.
/// REQUIRES a hit with a face (ContractError).
Surface surfaceAt(const world::Plan& plan, const WallHit& hit);

}  // namespace slam::rays
