#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/calibration/thinned_sample.h"
#include "libslam/core/pose2.h"

namespace mrpt::obs {
class CObservation2DRangeScan;
}

namespace slam::calibration {

/// A pile of readings at the far end of all: what the lidar says where it meets nothing.
struct NoReturnSpike {
  double low_m = 0, high_m = 0;  ///< of the pile; nothing lies beyond it
  double peak_m = 0;             ///< its commonest value, to a centimetre
  double threshold_m = 0;        ///< readings from here on are no-returns: half a centimetre below low_m
  std::uint64_t readings = 0;
  std::uint64_t as_returns = 0;  ///< of these, how many the log gives as distances to something
};

/// A lidar's readings as the log has them, before anything is made of them.
struct RangeFigures {
  std::uint64_t scans = 0;
  int beams = 0;  ///< this and the next three: of the first scan
  double aperture_rad = 0, max_range_m = 0;
  core::Pose2 T_robot_lidar;
  double mount_z_m = 0, mount_tilt_rad = 0;  ///< height, and the larger of pitch and roll
  std::uint64_t geometry_changes = 0;        ///< scans that differ in one of these from the scan before
  std::uint64_t readings = 0;
  std::uint64_t returns = 0;     ///< valid, above 0 and below the maximum range
  std::uint64_t no_returns = 0;  ///< at or beyond the maximum range, however flagged
  std::uint64_t zeros = 0;       ///< 0 or less
  std::uint64_t not_finite = 0;
  std::uint64_t other_invalid = 0;  ///< flagged invalid although between 0 and the maximum range
  double median_m = 0;              ///< of the returns
  double largest_m = 0;             ///< of all finite readings
  std::optional<NoReturnSpike> spike;
  std::uint64_t duplicates = 0;             ///< scans with the same readings as the scan before, bit for bit
  std::uint64_t longest_duplicate_run = 0;  ///< scans after the first of a run of equal ones
  std::vector<int> dead_beams;    ///< gave no return, zero or invalid, in all scans, while most beams do
  std::vector<int> silent_beams;  ///< always no-returns, while most beams give returns
  std::vector<int>
      stuck_beams;  ///< always the same reading, to 3 cm, while the median beam varies by far more
};

class RangeTally {
 public:
  RangeTally();
  void add(const mrpt::obs::CObservation2DRangeScan& scan);
  RangeFigures figures() const;

 private:
  struct Beam {
    std::uint64_t returns = 0, no_returns = 0;
    double mean_m = 0, squares_m2 = 0;  ///< running mean and sum of squared departures (Welford)
  };
  void takeGeometry(const mrpt::obs::CObservation2DRangeScan& scan);
  std::optional<NoReturnSpike> findSpike() const;
  void findBadBeams(RangeFigures& figures) const;

  RangeFigures sums_;
  std::uint64_t run_ = 0;
  std::vector<float> before_;
  std::vector<Beam> beams_;
  ThinnedSample returns_m_;
  /// The readings in one centimetre of range.
  struct Bin {
    std::uint32_t all = 0, as_returns = 0;
    std::uint16_t first_beam = 0xFFFF, last_beam = 0;
  };
  std::vector<Bin> bins_;  ///< up to 655 m
  RangeFigures last_;      ///< geometry of the scan before
};

}  // namespace slam::calibration
