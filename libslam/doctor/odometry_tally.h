#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/doctor/log_check.h"
#include "libslam/doctor/thinned_sample.h"

namespace slam::doctor {

/// Path and jumps of one source of odometry, in file order.
class OdometryTally {
 public:
  void add(std::optional<double> time_s, const core::Pose2& pose);
  OdometryFigures figures(const std::string& stream) const;

 private:
  static constexpr double kShortest_m = 0.5, kFast_mps = 3, kSmallest_rad = 0.5, kFast_radps = 5;
  static constexpr std::size_t kMostKept = 4096;
  struct Suspect {
    double moved_m, duration_s;
  };
  OdometryFigures figures_;
  std::optional<core::Pose2> last_;
  std::optional<double> last_s_;
  ThinnedSample speeds_mps_;
  std::uint64_t sure_ = 0;
  std::vector<Suspect> kept_;
  double largest_m_ = -1, largest_at_s_ = 0;
};

}  // namespace slam::doctor
