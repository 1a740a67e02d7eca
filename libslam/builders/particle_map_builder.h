#pragma once
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/slam/CMetricMapBuilder.h>

#include <memory>
#include <vector>

#include "libslam/builders/mapping_options.h"
#include "libslam/builders/mrpt_compat.h"
#include "libslam/particles/particle_filter.h"

namespace slam::builders {

/// ParticleFilter behind MRPT's interface. Of an action collection the best movement estimation counts (MRPT:
/// scan matching before odometry), with its covariance; a collection without one leaves the motion open. Of
/// the frame the first 2D range scan counts; a frame without any is ignored, its motion is kept for the next.
///
/// The pose estimation is a Gaussian with the covariance of ParticleStep. The simple map's key frames are the
/// scans (as lidar::toMrpt() writes them) that entered the particles' maps, at the best particle's corrected
/// poses. The metric map is one occupancy grid of resolution_m, drawn from the key frames when it is asked
/// for: exactly (gridmap::Grid), and anew when the best particle's past is another one than at the last time.
///
/// options.enableMapUpdating = false localises in the map as it is. initialize() with key frames starts from
/// a map that is drawn of them, in which the robot stands at x0.
class ParticleMapBuilder : public mrpt::slam::CMetricMapBuilder {
 public:
  ParticleMapBuilder(const particles::ParticleFilterOptions& filter, const MappingOptions& mapping,
                     std::uint64_t seed);

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

  /// The same without MRPT's scans: what lidars saw at one moment, the first of which leads, and the motion
  /// since the scan before.
  void processScans(const lidar::Scan& scan, const std::vector<lidar::Scan>& others,
                    const mrpt::poses::CPosePDF& motion);
  /// So many threads, or as many as the filter's options have; stays when it is initialized anew.
  void useThreads(int threads);
  /// After the last scan: the loops that are left.
  void finish();

  const particles::ParticleFilter& filter() const { return *filter_; }

 private:
  struct KeyFrame {
    std::uint64_t scan;  ///< index into the path
    std::vector<lidar::Scan> seen;
    double max_range_m;  ///< up to which it entered the particles' maps
  };
  void addMotion(const mrpt::poses::CPosePDF& motion);
  void takeIn(const lidar::Scan& scan, const std::vector<lidar::Scan>& others);
  void drawMap() const;

  particles::ParticleFilterOptions filter_options_;
  std::uint64_t seed_;
  std::unique_ptr<particles::ParticleFilter> filter_;
  std::optional<particles::Motion> motion_;  ///< since the last scan
  std::vector<KeyFrame> key_frames_;
  mrpt::maps::CSimpleMap initial_map_;
  gridmap::Grid start_map_;  ///< of initial_map_

  // The metric map, made when it is asked for.
  mutable mrpt::maps::CMultiMetricMap maps_;
  mutable mrpt::maps::COccupancyGridMap2D::Ptr published_;
  mutable gridmap::Grid drawn_;
  mutable std::vector<core::Pose2> drawn_poses_;  ///< of the first key frames, those that drawn_ holds
  mutable bool up_to_date_ = false;
};

}  // namespace slam::builders
