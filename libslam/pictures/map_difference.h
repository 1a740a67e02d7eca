#pragma once
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/draw/canvas.h"
#include "libslam/draw/map_view.h"
#include "libslam/metrics/map_score.h"
#include "libslam/world/plan.h"

namespace slam::pictures {

/// An estimated map laid over the true plan, point by point: what drawDifference() (picture.h) draws, which
/// says what the colours mean. T_world_map not finite: the truth alone. REQUIRES a mask of the plan's size
/// (ContractError).
class MapDifference {
 public:
  MapDifference(const world::Plan& plan, const world::CellMap& map, const core::Pose2& T_world_map,
                const metrics::SeenMask* seen);
  /// The most telling colour within the square of that side around the point.
  draw::Colour colourAt(const core::Point2& p_world, double side_m) const;
  std::vector<draw::LegendEntry> legend() const;

 private:
  double tolerance_m_;
  bool has_seen_;
  draw::LabelRaster truth_labels_, map_labels_;
};

}  // namespace slam::pictures
