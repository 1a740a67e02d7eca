#pragma once
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include "libslam/builders/mapping_options.h"
#include "libslam/builders/mrpt_compat.h"
#include "libslam/core/pose2.h"

namespace slam::builders {

/// The original robot's map: every return is put as a dot at the dead-reckoned pose and nothing is ever
/// corrected. The pose is the sum of the actions' best movement estimations (MRPT: scan matching before
/// odometry). With draw = rays whole rays change the occupancy, as in the other methods. The map holds one
/// occupancy grid; with dots a cell is either fully occupied or unknown.
///
/// Every scan is drawn, or with draw_after = moves those after an increment that is a move or an arc
/// (robot::kindOf; the increments of argmax are pure, those of other odometry are told apart by it): in a
/// turn in place the original odometry errs most, and the robot sees little that is new. Scans that are
/// drawn, and the first, become key frames of the simple map after insert_distance_m or insert_angle_deg.
class NaiveMapBuilder : public mrpt::slam::CMetricMapBuilder {
 public:
  explicit NaiveMapBuilder(const MappingOptions& mapping);

  void initialize(const mrpt::maps::CSimpleMap& initialMap = mrpt::maps::CSimpleMap(),
                  const mrpt::poses::CPosePDF* x0 = nullptr) override;
  mrpt::poses::CPose3DPDF::Ptr getCurrentPoseEstimation() const override;
  void processActionObservation(mrpt::obs::CActionCollection& action,
                                mrpt::obs::CSensoryFrame& observations) override;
  void getCurrentlyBuiltMap(mrpt::maps::CSimpleMap& out_map) const override;
  compat::MapSize getCurrentlyBuiltMapSize() override;
  compat::BuiltMap getCurrentlyBuiltMetricMap() const override;
  /// Writes a picture of the grid; the format follows the suffix.
  void saveCurrentEstimationToImage(RASTERSLAM_MRPT_SAVE_IMAGE_ARGUMENTS) override;

 private:
  bool isDrawnAfter(const core::Pose2& increment) const;
  void draw(const mrpt::obs::CSensoryFrame& observations);
  bool isKeyFrame() const;

  MappingOptions options_;
  mrpt::maps::CMultiMetricMap maps_;
  mrpt::maps::COccupancyGridMap2D::Ptr grid_;  ///< the one in maps_
  mrpt::maps::CSimpleMap key_frames_;
  mrpt::poses::CPose2D T_map_robot_, T_map_key_frame_;
};

}  // namespace slam::builders
