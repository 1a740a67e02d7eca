#include "libslam/builders/graph_map_builder.h"

#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPosePDF.h>
#include <mrpt/poses/CPosePDFGaussian.h>

#include <algorithm>
#include <cmath>

#include "libslam/builders/map_grid.h"
#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::builders {
namespace {

mrpt::poses::CPose3DPDFGaussian gaussian(const core::Pose2& T_map_robot, const Eigen::Matrix3d& covariance) {
  mrpt::poses::CPosePDFGaussian planar;
  planar.mean = mrpt::poses::CPose2D(lidar::toMrpt(T_map_robot));
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) planar.cov(row, column) = covariance(row, column);
  mrpt::poses::CPose3DPDFGaussian pose;
  pose.copyFrom(planar);
  return pose;
}

}  // namespace

GraphMapBuilder::GraphMapBuilder(const MappingOptions& mapping, const keyframes::GraphOptions& graph)
    : mapping_(mapping), graph_options_(graph), graph_(graph) {
  initialize();
}

void GraphMapBuilder::initialize(const mrpt::maps::CSimpleMap& initialMap, const mrpt::poses::CPosePDF* x0) {
  graph_ = graph::GraphSlam(graph_options_);
  graph_.useThreads(threads_);
  last_ = {};
  maps_.maps.clear();
  grid_.reset();
  addKnownKeyframes(initialMap);
  if (graph_.keyframeCount() == 0) return;
  last_.T_map_robot = graph_.keyframePose(graph_.keyframeCount() - 1);
  if (x0 != nullptr) last_.T_map_robot = lidar::fromMrpt(x0->getMeanVal().asTPose());
  graph_.startAt(last_.T_map_robot);
}

void GraphMapBuilder::useThreads(int threads) {
  threads_ = threads;
  graph_.useThreads(threads);
}

void GraphMapBuilder::addKnownKeyframes(const mrpt::maps::CSimpleMap& map) {
  for (size_t i = 0; i < map.size(); ++i) {
    const auto [pose, frame] = compat::frameOf(map, i);
    const auto observation = frame->getObservationByClass<mrpt::obs::CObservation2DRangeScan>();
    if (!observation) continue;
    const auto mean = pose->getMeanVal();
    graph_.addKnownKeyframe(lidar::fromMrpt(*observation), {mean.x(), mean.y(), mean.yaw()});
  }
}

void GraphMapBuilder::addPart(const mrpt::maps::CSimpleMap& map) {
  graph_.beginKnownPart();
  addKnownKeyframes(map);
}

mrpt::poses::CPose3DPDF::Ptr GraphMapBuilder::getCurrentPoseEstimation() const {
  return std::make_shared<mrpt::poses::CPose3DPDFGaussian>(
      gaussian(last_.T_map_robot, last_.pose_covariance));
}

core::Pose2 GraphMapBuilder::processScan(const lidar::Scan& scan, const core::Pose2& T_previous_robot,
                                         bool has_odometry) {
  last_ = options.enableMapUpdating ? graph_.process(scan, T_previous_robot, has_odometry)
                                    : graph_.localise(scan, T_previous_robot, has_odometry);
  return last_.T_map_robot;
}

void GraphMapBuilder::processActionObservation(mrpt::obs::CActionCollection& action,
                                               mrpt::obs::CSensoryFrame& observations) {
  core::Pose2 increment;
  const auto movement = action.getBestMovementEstimation();
  if (movement) increment = lidar::fromMrpt(movement->poseChange->getMeanVal().asTPose());
  bool has_odometry = movement != nullptr;
  for (const auto& observation : observations) {
    const auto scan = std::dynamic_pointer_cast<mrpt::obs::CObservation2DRangeScan>(observation);
    if (!scan) continue;
    processScan(lidar::fromMrpt(*scan), increment, has_odometry);
    increment = {};
    has_odometry = false;
  }
}

void GraphMapBuilder::getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& out_map) const {
  out_map.clear();
  for (int k = 0; k < graph_.keyframeCount(); ++k) {
    const lidar::Scan& scan = graph_.keyframeScan(k);
    if (scan.ranges_m.empty()) continue;
    mrpt::obs::CSensoryFrame frame;
    lidar::addTo(frame, scan, scan.time_s);
    compat::insertFrame(out_map, gaussian(graph_.keyframePose(k), Eigen::Matrix3d::Zero()), frame);
  }
}

compat::MapSize GraphMapBuilder::getCurrentlyBuiltMapSize() {
  int kept = 0;
  for (int k = 0; k < graph_.keyframeCount(); ++k) kept += !graph_.keyframeScan(k).ranges_m.empty();
  return static_cast<compat::MapSize>(kept);
}

/// MRPT's grids grow without limit: a path that has come apart is stopped before it is drawn.
void GraphMapBuilder::requireBounded() const {
  if (graph_.keyframeCount() == 0) return;
  double x_min = 1e300, x_max = -1e300, y_min = 1e300, y_max = -1e300;
  for (int k = 0; k < graph_.keyframeCount(); ++k) {
    const core::Pose2& pose = graph_.keyframePose(k);
    x_min = std::min(x_min, pose.x), x_max = std::max(x_max, pose.x);
    y_min = std::min(y_min, pose.y), y_max = std::max(y_max, pose.y);
  }
  const double reach_m = 2 * mapping_.max_insert_range_m;
  const double cells =
      (x_max - x_min + reach_m) * (y_max - y_min + reach_m) / (mapping_.resolution_m * mapping_.resolution_m);
  if (!(cells <= mapping_.max_map_cells))
    throw core::MethodError(tooManyCells(cells, mapping_.max_map_cells));
}

compat::BuiltMap GraphMapBuilder::getCurrentlyBuiltMetricMap() const {
  if (!grid_ || drawn_revision_ != graph_.revision()) {
    grid_ = makeMapGrid(mapping_);
    maps_.maps.clear();
    maps_.maps.push_back(grid_);
    drawn_keyframes_ = 0;
    drawn_revision_ = graph_.revision();
  }
  if (drawn_keyframes_ < graph_.keyframeCount()) requireBounded();
  for (; drawn_keyframes_ < graph_.keyframeCount(); ++drawn_keyframes_) {
    const lidar::Scan& scan = graph_.keyframeScan(drawn_keyframes_);
    if (scan.ranges_m.empty()) continue;
    const auto observation = lidar::toMrpt(scan);
    const mrpt::poses::CPose3D pose(
        mrpt::poses::CPose2D(lidar::toMrpt(graph_.keyframePose(drawn_keyframes_))));
    grid_->insertObservation(*observation, pose);
  }
  return compat::builtMap(maps_);
}

void GraphMapBuilder::saveCurrentEstimationToImage(RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS) {
  getCurrentlyBuiltMetricMap();
  grid_->saveAsBitmapFile(file);
}

}  // namespace slam::builders
