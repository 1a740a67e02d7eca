#pragma once
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include <vector>

#include "libslam/builders/mapping_options.h"
#include "libslam/builders/mrpt_compat.h"
#include "libslam/graph/graph_slam.h"

namespace slam::builders {

/// GraphSlam as MRPT knows map builders. The metric map is one occupancy grid with the scans of all
/// keyframes, drawn when it is asked for: only what is new, or all of it when keyframes have moved. The pose
/// comes with its covariance against the keyframes around.
///
/// initialize() with a map continues it: its first scans are keyframes at their mean poses, and x0 says where
/// the robot is (default: the last keyframe's pose). With options.enableMapUpdating = false the robot is only
/// localised in it. From an action its best movement estimation is odometry; without one the last motion
/// stands in. REQUIRES lidars of one geometry; scans of a frame after the first count as scans of their own
/// without odometry.
class GraphMapBuilder : public mrpt::slam::CMetricMapBuilder {
 public:
  GraphMapBuilder(const MappingOptions& mapping, const keyframes::GraphOptions& graph);

  void initialize(const mrpt::maps::CSimpleMap& initialMap = mrpt::maps::CSimpleMap(),
                  const mrpt::poses::CPosePDF* x0 = nullptr) override;
  mrpt::poses::CPose3DPDF::Ptr getCurrentPoseEstimation() const override;
  void processActionObservation(mrpt::obs::CActionCollection& action,
                                mrpt::obs::CSensoryFrame& observations) override;
  void getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& out_map) const override;
  compat::MapSize getCurrentlyBuiltMapSize() override;
  /// Errors: MethodError when the grid would hold more than [mapping] max_map_cells.
  compat::BuiltMap getCurrentlyBuiltMetricMap() const override;
  /// Writes a picture of the grid; the format follows the suffix.
  void saveCurrentEstimationToImage(RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS) override;

  /// The same as processActionObservation() without MRPT's types in between.
  core::Pose2 processScan(const lidar::Scan& scan, const core::Pose2& T_previous_robot, bool has_odometry);
  void finish(core::Progress& progress = core::silentProgress()) { graph_.finish(progress); }
  /// See GraphSlam; stays when it is initialized anew.
  void useThreads(int threads);
  /// After initialize() with a map: nobody knows where in it the robot is. REQUIRES options.enableMapUpdating
  /// = false from then on.
  void startAnywhere() { graph_.startAnywhere(); }
  /// After initialize() with a map: another map, whose place in the first is not known, to be found by
  /// joinParts(). REQUIRES no scan before.
  void addPart(const mrpt::maps::CSimpleMap& map);
  std::vector<loops::PartPlace> joinParts(core::Progress& progress) { return graph_.joinParts(progress); }
  const graph::GraphSlam& graph() const { return graph_; }

 private:
  void requireBounded() const;
  void addKnownKeyframes(const mrpt::maps::CSimpleMap& map);

  MappingOptions mapping_;
  keyframes::GraphOptions graph_options_;
  int threads_ = 1;
  graph::GraphSlam graph_;
  graph::GraphSlam::Step last_;
  // Drawn when asked for.
  mutable mrpt::maps::CMultiMetricMap maps_;
  mutable mrpt::maps::COccupancyGridMap2D::Ptr grid_;  ///< the one in maps_
  mutable int drawn_keyframes_ = 0, drawn_revision_ = 0;
};

}  // namespace slam::builders
