#include "libslam/builders/naive_map_builder.h"

#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDF.h>

#include <algorithm>
#include <cmath>

#include "libslam/builders/map_grid.h"
#include "libslam/core/elementary.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/motion_kind.h"

namespace slam::builders {
namespace {

/// Puts a dot into every cell that a return falls into. Grows the grid first where needed.
void drawDots(mrpt::maps::COccupancyGridMap2D& grid, const std::vector<core::Point2>& points,
              const core::Pose2& T_map_robot) {
  std::vector<core::Point2> dots;
  dots.reserve(points.size());
  const core::RigidMotion2 T_map_points(T_map_robot);
  for (const auto& p_robot : points) dots.push_back(T_map_points * p_robot);
  double x_min = grid.getXMin(), x_max = grid.getXMax(), y_min = grid.getYMin(), y_max = grid.getYMax();
  // Two cells more than the outermost dot, so that rounding never puts it outside.
  const double margin_m = 2 * static_cast<double>(grid.getResolution());
  for (const auto& dot : dots) {
    x_min = std::min(x_min, dot.x - margin_m), x_max = std::max(x_max, dot.x + margin_m);
    y_min = std::min(y_min, dot.y - margin_m), y_max = std::max(y_max, dot.y + margin_m);
  }
  grid.resizeGrid(static_cast<float>(x_min), static_cast<float>(x_max), static_cast<float>(y_min),
                  static_cast<float>(y_max));
  for (const auto& dot : dots) grid.setCell(grid.x2idx(dot.x), grid.y2idx(dot.y), 0.0F);
}

}  // namespace

NaiveMapBuilder::NaiveMapBuilder(const MappingOptions& mapping) : options_(mapping) {
  initialize();
}

void NaiveMapBuilder::initialize(const mrpt::maps::CSimpleMap& initialMap, const mrpt::poses::CPosePDF* x0) {
  grid_ = makeMapGrid(options_);
  maps_.maps.clear();
  maps_.maps.push_back(grid_);
  T_map_robot_ = x0 != nullptr ? x0->getMeanVal() : mrpt::poses::CPose2D();
  T_map_key_frame_ = T_map_robot_;
  key_frames_ = initialMap;
  if (!key_frames_.empty()) maps_.loadFromSimpleMap(key_frames_);
}

mrpt::poses::CPose3DPDF::Ptr NaiveMapBuilder::getCurrentPoseEstimation() const {
  auto pose = mrpt::poses::CPose3DPDFGaussian::Create();
  pose->mean = mrpt::poses::CPose3D(T_map_robot_);
  return pose;
}

void NaiveMapBuilder::processActionObservation(mrpt::obs::CActionCollection& action,
                                               mrpt::obs::CSensoryFrame& observations) {
  mrpt::poses::CPose2D increment;
  if (const auto movement = action.getBestMovementEstimation())
    increment = movement->poseChange->getMeanVal();
  // Not MRPT's composition, whose sine is the C library's.
  T_map_robot_ = mrpt::poses::CPose2D(
      lidar::toMrpt(lidar::fromMrpt(T_map_robot_.asTPose()) * lidar::fromMrpt(increment.asTPose())));
  if (!options.enableMapUpdating) return;
  const bool is_drawn = isDrawnAfter(lidar::fromMrpt(increment.asTPose()));
  if (is_drawn) draw(observations);
  if ((!is_drawn && !key_frames_.empty()) || !isKeyFrame()) return;
  mrpt::poses::CPose3DPDFGaussian pose;
  pose.mean = mrpt::poses::CPose3D(T_map_robot_);
  compat::insertFrame(key_frames_, pose, observations);
  T_map_key_frame_ = T_map_robot_;
}

bool NaiveMapBuilder::isDrawnAfter(const core::Pose2& increment) const {
  if (options_.draw_after == "every_scan") return true;
  const auto kind = robot::kindOf(increment);
  return kind == robot::MotionKind::kMove || kind == robot::MotionKind::kArc;
}

void NaiveMapBuilder::draw(const mrpt::obs::CSensoryFrame& observations) {
  for (size_t i = 0; i < observations.size(); ++i) {
    const auto& observation = observations.getObservationByIndex(i);
    const auto scan = std::dynamic_pointer_cast<mrpt::obs::CObservation2DRangeScan>(observation);
    if (!scan) continue;
    if (options_.draw == "rays")
      grid_->insertObservation(*scan, mrpt::poses::CPose3D(T_map_robot_));
    else
      drawDots(*grid_, lidar::scanPoints(lidar::fromMrpt(*scan)), lidar::fromMrpt(T_map_robot_.asTPose()));
  }
}

bool NaiveMapBuilder::isKeyFrame() const {
  if (key_frames_.empty() || options.debugForceInsertion) return true;
  const core::Pose2 travelled =
      core::between(lidar::fromMrpt(T_map_key_frame_.asTPose()), lidar::fromMrpt(T_map_robot_.asTPose()));
  return core::hypot(travelled.x, travelled.y) >= options_.insert_distance_m ||
         std::abs(travelled.phi) >= options_.insert_angle_rad;
}

void NaiveMapBuilder::getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& out_map) const {
  out_map = key_frames_;
}

compat::MapSize NaiveMapBuilder::getCurrentlyBuiltMapSize() {
  return static_cast<compat::MapSize>(key_frames_.size());
}

compat::BuiltMap NaiveMapBuilder::getCurrentlyBuiltMetricMap() const {
  return compat::builtMap(maps_);
}

void NaiveMapBuilder::saveCurrentEstimationToImage(RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS) {
  grid_->saveAsBitmapFile(file);
}

}  // namespace slam::builders
