#pragma once
#include <optional>

#include "libslam/lidar/deskew.h"
#include "libslam/mapping/method_options.h"
#include "libslam/mapping/step_motion.h"
#include "libslam/scanmatch/surfel_matcher.h"

namespace slam::mapping {

/// What became of the scans that a spinning lidar swept.
struct SweptScans {
  std::uint64_t swept = 0;      ///< of a known sweep, after the first
  std::uint64_t set_right = 0;  ///< of these
};

/// Takes out of scans what the robot's motion did to them, where the method wants that and it can be known.
/// The motion is the odometry's; where a sweep takes up to half of the time between scans, as a match to the
/// scan before of the same lidar corrects it: a step's odometry errs by more than its beams may be off.
/// Longer sweeps are asked only whether wheels have slipped, where odometry is far from how the robot moved
/// before: then that goes on, or the robot turns by something between and beyond both, if the scan so
/// deskewed fits distinctly better to the one before. What the motion errs by is left to the method, see
/// lidar::Deskewing.
class ScanDeskewer {
 public:
  /// `unskews_alone`: the method finds by itself how the robot moved meanwhile (tracking::Unskewer), also
  /// where there is no odometry.
  explicit ScanDeskewer(const MethodOptions& method, bool unskews_alone = false)
      : method_(method), unskews_alone_(unskews_alone) {}

  /// nullopt: the scan stays as it is. `sweep` as whoever measured it says; [method] sweep_s comes before it.
  std::optional<lidar::Scan> deskewed(const StepHistory& history, const lidar::Scan& scan,
                                      std::optional<lidar::Sweep> sweep, const core::Pose2& T_previous_robot,
                                      bool has_odometry);
  /// How the robot moved up to the scan of the last call, where that showed that wheels had slipped in a long
  /// sweep: by the match of the scan to the one before, as T_previous_robot has it (m, rad). Nothing where
  /// odometry holds.
  const std::optional<core::Pose2>& movedInstead() const { return moved_instead_; }
  const SweptScans& counts() const { return counts_; }

 private:
  scanmatch::MatchResult matched(const lidar::Scan& deskewed, const core::Pose2& guess,
                                 const scanmatch::PosePrior& odometry) const;
  lidar::Scan deskewedByMatch(const StepHistory& history, const lidar::Scan& scan,
                              const core::Pose2& T_previous_robot, double period_s,
                              const lidar::Sweep& sweep);

  MethodOptions method_;
  bool unskews_alone_;
  SweptScans counts_;
  std::optional<core::Pose2> moved_instead_;
  scanmatch::SurfelMap coarse_{0.2, 0.04}, fine_{0.1, 0.02};  ///< of the scan before
};

}  // namespace slam::mapping
