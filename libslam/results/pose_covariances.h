#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/symmetric3.h"

namespace slam::results {

/// How sure a method says that it is of a pose.
struct StampedCovariance {
  double time_s = 0;            ///< of the scan, as in the log
  core::Symmetric3 covariance;  ///< of x (m), y (m), phi (rad) in the map frame
};

/// covariances.csv: `time_s,xx,xy,xphi,yy,yphi,phiphi` per scan, in the order of trajectory.tum; 6 decimals
/// of a second, 9 significant digits. Same covariances, same bytes. Errors of reading: InputError with
/// file:line for a line that is not 7 finite numbers.
void writeCovariances(const std::vector<StampedCovariance>& covariances, const std::string& path);
std::vector<StampedCovariance> readCovariances(const std::string& path);

inline constexpr int kPoseDegreesOfFreedom = 3;
/// NEES of every pose (stats::normalizedErrorSquared) with kPoseDegreesOfFreedom: the error of (x, y, phi) in
/// the map frame, which is the true pose at the estimate's first stamp; nothing else is aligned. So the
/// covariances must speak of the error since the start. T_world_map: where the map frame lies instead, where
/// a map was known from before. covariances[i] belongs to estimate[i]. A covariance that is not positive
/// definite claims a certainty: infinite where the pose is off by more than a file's rounding (a micrometre,
/// a microradian), else left out (the start is given). Left out too: poses without a truth at their stamp.
/// Empty when the truth does not know the first stamp.
/// REQUIRES as many covariances as poses (ContractError).
std::vector<double> poseNees(const core::Trajectory& truth, const core::Trajectory& estimate,
                             const std::vector<StampedCovariance>& covariances,
                             const std::optional<core::Pose2>& T_world_map = std::nullopt);

}  // namespace slam::results
