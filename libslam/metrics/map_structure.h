#pragma once
#include <cstddef>

#include "libslam/world/cell_map.h"

namespace slam::metrics {

/// What the walls of an estimated map say of it without any truth: the three measures of Filatov et al., "2D
/// SLAM Quality Evaluation Methods", 2017 (arXiv 1708.02354). A scan put down in a wrong place draws its
/// walls a second time, so of two maps of one log the worse one tends to have more of each.
///
/// What they cannot say: whether the map is globally distorted (every wall drawn once, in a wrong place,
/// scores well); and nothing across rasterisers: cell size, how a method draws a ray and when it calls a cell
/// occupied move all three. So compare maps of one log, drawn by one grid with one cell size.
struct MapStructure {
  /// Occupied cells over known ones (occupied and free). The paper divides by the free cells instead: p / (1
  /// - p) of ours. NaN without known cells.
  double occupied_share;
  /// Places where walls meet, cross or end; what lies within some 0.4 m counts once. These are the groups
  /// (8-connected) of occupied cells at which the walls go two ways: the Harris response with k =
  /// kCornerRoundness / 4 is positive, which is 4 det(A) / trace(A)^2 > kCornerRoundness for the structure
  /// tensor A of the walls' picture (Harris and Stephens, Alvey Vision Conference 1988; as a ratio: Förstner
  /// and Gülch 1987), blurred by kCornerBlur_m, in a Gaussian window of kCornerWindow_m. Groups of occupied
  /// cells that would fit into a square of kSpeck_m are no walls and are removed before. The paper runs
  /// Harris' detector over the Laplacian of the picture and keeps what is within a share of the strongest
  /// response; ours needs no strongest corner and no second derivative, and its lengths are metres.
  std::size_t corners;
  /// 4-connected free areas of at least kSmallestArea_m2, but for the largest one. In the paper: areas within
  /// walls or unknown cells, by the contours of the free space.
  std::size_t enclosed_areas;
};
inline constexpr double kCornerBlur_m = 0.075;
inline constexpr double kCornerWindow_m = 0.15;
inline constexpr double kCornerRoundness = 0.5;
inline constexpr double kSpeck_m = 0.3;
inline constexpr double kSmallestArea_m2 = 0.05;

/// The same for a map that is turned by a quarter, mirrored, or padded with unknown cells. An empty map: NaN,
/// 0, 0. Cost: a quarter of a second for a map of 1500 x 1000 cells.
MapStructure mapStructure(const world::CellMap& map);

}  // namespace slam::metrics
