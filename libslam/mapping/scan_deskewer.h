#pragma once
#include <optional>

#include "libslam/mapping/method_options.h"
#include "libslam/mapping/step_motion.h"
#include "libslam/robot/deskew.h"

namespace slam::mapping {

/// What became of the scans that a turning lidar swept.
struct SweptScans {
  std::uint64_t swept = 0;      ///< of a known sweep, after the first
  std::uint64_t set_right = 0;  ///< of these
};

/// Takes out of scans what the robot's motion did to them, where the method wants that and it can be known.
class ScanDeskewer {
 public:
  explicit ScanDeskewer(const MethodOptions& method) : method_(method) {}

  /// nullopt: the scan stays as it is. `sweep` as whoever measured it says; [method] sweep_s comes before it.
  std::optional<robot::Scan> deskewed(const StepHistory& history, const robot::Scan& scan,
                                      std::optional<robot::Sweep> sweep, const core::Pose2& T_previous_robot,
                                      bool has_odometry);
  const SweptScans& counts() const { return counts_; }

 private:
  MethodOptions method_;
  SweptScans counts_;
};

}  // namespace slam::mapping
