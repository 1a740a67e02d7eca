#include "libslam/pictures/map_difference.h"

#include <algorithm>

#include "libslam/core/error.h"
#include "libslam/metrics/nearest_points.h"

namespace slam::pictures {
namespace {

/// Labels of the difference, see LabelRaster. Of the true plan:
enum TrueLabel : unsigned char {
  kTrueUnknown,
  kTrueFree,
  kInsideWall,
  kUnseenFace,
  kAgreedFace,
  kMissedFace
};
/// And of the map:
enum MapLabel : unsigned char { kMapUnknown, kMapFree, kAgreedWall, kWrongWall };

/// A wall cell that touches free space, be it at a corner: what can be seen of a wall.
bool isFace(const world::Plan& plan, int column, int row) {
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx)
      if (plan.contains(column + dx, row + dy) && plan.at(column + dx, row + dy) == world::Cell::kFree)
        return true;
  return false;
}

core::Point2 centre(const world::CellMap& raster, const core::Pose2& T_world_raster, int column, int row) {
  return T_world_raster *
         core::Point2{(column + 0.5) * raster.resolution_m, (row + 0.5) * raster.resolution_m};
}

std::vector<core::Point2> wallCentres(const world::CellMap& raster, const core::Pose2& T_world_raster) {
  std::vector<core::Point2> centres;
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column)
      if (raster.at(column, row) == world::Cell::kOccupied)
        centres.push_back(centre(raster, T_world_raster, column, row));
  return centres;
}

draw::LabelRaster labelTruth(const world::Plan& plan, const metrics::NearestPoints& map_walls,
                             double tolerance_m, const metrics::SeenMask* seen) {
  return draw::LabelRaster(plan, plan.T_frame_raster, [&](int column, int row) {
    const auto cell = plan.at(column, row);
    if (cell != world::Cell::kOccupied) return cell == world::Cell::kFree ? kTrueFree : kTrueUnknown;
    if (!isFace(plan, column, row)) return kInsideWall;
    const double distance_m = map_walls.distance(centre(plan, plan.T_frame_raster, column, row));
    if (distance_m <= tolerance_m) return kAgreedFace;
    return !seen || seen->wall[static_cast<size_t>(row) * plan.columns + column] ? kMissedFace : kUnseenFace;
  });
}

draw::LabelRaster labelMap(const world::CellMap& map, const core::Pose2& T_world_raster,
                           const metrics::NearestPoints& true_walls, double tolerance_m) {
  return draw::LabelRaster(map, T_world_raster, [&](int column, int row) {
    const auto cell = map.at(column, row);
    if (cell != world::Cell::kOccupied) return cell == world::Cell::kFree ? kMapFree : kMapUnknown;
    return true_walls.distance(centre(map, T_world_raster, column, row)) <= tolerance_m ? kAgreedWall
                                                                                        : kWrongWall;
  });
}

constexpr draw::Colour kSolid{190, 190, 190}, kUnseen{160, 168, 176}, kClaimedFree{250, 222, 200},
    kMissed = draw::kBlue, kWrong = draw::kVermillion;

draw::Colour differenceColour(unsigned char truth, unsigned char map) {
  if (map == kWrongWall) return kWrong;
  if (truth == kMissedFace) return kMissed;
  if (map == kAgreedWall || truth == kAgreedFace) return draw::kWall;
  if (map == kMapFree) return truth == kTrueFree ? draw::kFree : kClaimedFree;
  if (truth == kUnseenFace) return kUnseen;
  return truth == kInsideWall ? kSolid : draw::kUnknown;
}

}  // namespace

MapDifference::MapDifference(const world::Plan& plan, const world::CellMap& map,
                             const core::Pose2& T_world_map, const metrics::SeenMask* seen)
    : tolerance_m_(2 * std::max(plan.resolution_m, map.resolution_m)), has_seen_(seen != nullptr) {
  if (seen && (seen->columns != plan.columns || seen->rows != plan.rows))
    throw core::ContractError("MapDifference: the mask is not of the plan's size");
  const auto T_world_raster = T_world_map * map.T_frame_raster;
  const bool placed = core::isFinite(T_world_raster);
  const metrics::NearestPoints true_walls(wallCentres(plan, plan.T_frame_raster));
  const metrics::NearestPoints map_walls(placed ? wallCentres(map, T_world_raster)
                                                : std::vector<core::Point2>{});
  truth_labels_ = labelTruth(plan, map_walls, tolerance_m_, seen);
  if (placed) map_labels_ = labelMap(map, T_world_raster, true_walls, tolerance_m_);
}

draw::Colour MapDifference::colourAt(const core::Point2& p_world, double side_m) const {
  return differenceColour(truth_labels_.at(p_world, side_m), map_labels_.at(p_world, side_m));
}

std::vector<draw::LegendEntry> MapDifference::legend() const {
  using Kind = draw::LegendEntry::Kind;
  std::vector<draw::LegendEntry> legend = {
      {Kind::kBox, draw::kWall, "wall in both (within " + draw::stepLabel(tolerance_m_) + " m)"},
      {Kind::kBox, kWrong, "wall in the map only"},
      {Kind::kBox, kMissed, "wall in the truth only"}};
  if (has_seen_) legend.push_back({Kind::kBox, kUnseen, "wall never in view"});
  legend.insert(legend.end(), {{Kind::kBox, kClaimedFree, "free in the map only"},
                               {Kind::kBox, draw::kFree, "free in both"},
                               {Kind::kBox, draw::kUnknown, "not mapped"}});
  return legend;
}

}  // namespace slam::pictures
