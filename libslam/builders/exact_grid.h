#pragma once
#include <mrpt/maps/COccupancyGridMap2D.h>

#include "libslam/builders/mrpt_compat.h"

namespace slam::builders {

/// MRPT's occupancy grid with two errors of its scan insertion removed.
///
/// COccupancyGridMap2D steps the n rays of a scan by aperture / n, while the aperture of a
/// CObservation2DRangeScan reaches from the first ray to the last, so that the step is aperture / (n - 1) (as
/// getScanAngle() and the points maps have it). Every inserted scan is therefore squeezed, its last ray by a
/// whole step, and on average turned by half a step against the scan that is matched to it. This class hands
/// the insertion an equivalent scan for which aperture / n is the true step.
///
/// And with considerInvalidRangesAsFreeSpace the stock grid clears every invalid reading to half of
/// maxDistanceInsertion: beyond what a short-sighted lidar sees, and through walls where a reading was lost.
/// Here a reading at or beyond 0.99 of the scan's maxRange (nothing met) clears to the smaller of maxRange
/// and maxDistanceInsertion, and any other invalid reading changes nothing. Everything else is the stock
/// grid: options, likelihoods, matching.
///
/// In an .ini: `unbiasedGridMap_count = 1` and the sections PREFIX_unbiasedGridMap_00_creationOpts,
/// _insertOpts and _likelihoodOpts with the keys of occupancyGrid. Also in MRPT's own programs, when
/// librasterslam-mrpt.so is loaded into them. A file that holds this class needs that library too: save a
/// plain COccupancyGridMap2D (copyMapContentFrom) for others.
class ExactGrid : public mrpt::maps::COccupancyGridMap2D {
  DEFINE_SERIALIZABLE(ExactGrid, slam::builders)
 public:
  using mrpt::maps::COccupancyGridMap2D::COccupancyGridMap2D;

 protected:
  bool internal_insertObservation(const mrpt::obs::CObservation& observation,
                                  const std::optional<const mrpt::poses::CPose3D>& robot_pose) override;

  MAP_DEFINITION_START(ExactGrid)
  float min_x = -10, max_x = 10, min_y = -10, max_y = 10, resolution = 0.1F;
  mrpt::maps::COccupancyGridMap2D::TInsertionOptions insertion_options;
  mrpt::maps::COccupancyGridMap2D::TLikelihoodOptions likelihood_options;
  MAP_DEFINITION_END(ExactGrid)
};

/// Registers our map classes with MRPT, so that an .ini can name them: registerMaps(). Also done by loading
/// librasterslam-mrpt.so into a stock program (LD_PRELOAD).
void registerMaps();

}  // namespace slam::builders
