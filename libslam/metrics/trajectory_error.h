#pragma once
#include <cstddef>

#include "libslam/core/pose2.h"
#include "libslam/metrics/statistics.h"

namespace slam::metrics {

/// The rigid motion T_truth_estimate that brings the estimated positions nearest to the true ones, in the
/// sense of least squares over SE(2), without scale (Umeyama, PAMI 13(4), 1991, in the plane: closed form).
/// The two lists pair up by index. Headings take part only where positions leave the rotation open (all
/// equal, one pose, or every rotation equally good): then the first pair's headings give it. Positions that
/// are not finite give a pose of NaNs. REQUIRES lists of equal length, at least 1.
core::Pose2 alignPositions(const std::vector<core::Pose2>& truth, const std::vector<core::Pose2>& estimate);

/// How an estimate is laid onto the truth before distances are taken.
enum class Align {
  kNone,   ///< not at all: the estimate's frame has a known place in the truth's. For localisation in a map
  kFirst,  ///< as its first matched pose lies: what the error has grown to since the start
  kSe2     ///< by alignPositions()
};

/// Absolute trajectory error (Sturm et al., IROS 2012): the estimate is moved rigidly by alignPositions()
/// onto the truth, or as `align` says; then distances, and headings. Both frames' origins are therefore
/// irrelevant, but for Align::kNone.
struct TrajectoryError {
  ErrorStatistics position_m;    ///< ATE
  ErrorStatistics heading_rad;   ///< |heading error| after the same alignment
  core::Pose2 T_truth_estimate;  ///< the alignment; NaN where no pose is matched
  std::size_t unmatched = 0;     ///< estimated poses without a truth within reach (outside its time span)
};

/// Truth is interpolated to the estimate's stamps; `count` of the statistics is the number of matched poses.
/// No common stamp: all NaN, count 0. A matched pose that is not finite makes the statistics that it enters
/// NaN: a NaN position all of them, a NaN heading alone the heading's. A stamp that is not finite, or a truth
/// that is not: all NaN. Stamps that run back: ContractError.
/// T_truth_map: with Align::kNone alone, where the estimate's frame lies in the truth's.
TrajectoryError trajectoryError(const core::Trajectory& truth, const core::Trajectory& estimate,
                                Align align = Align::kSe2, const core::Pose2& T_truth_map = {});

/// Relative pose error (same source): for pairs of stamps (i, j) the error of the estimated relative motion,
/// E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j) with Q true and P estimated; no alignment. Stamps are those of the
/// estimate that have a truth. Every one of them starts a pair; a pair whose end lies past the trajectory's
/// is dropped. No pair: NaN statistics, count 0. NaN as in trajectoryError().
struct RelativeError {
  ErrorStatistics translation_m;  ///< length of E's translation; not divided by distance or time
  ErrorStatistics rotation_rad;   ///< |angle of E|
};
/// j: the first stamp at which the true path driven since i is at or past `distance_m` (with a micrometre of
/// slack for rounding). Measured along the whole truth, also between the estimate's stamps. REQUIRES > 0.
RelativeError relativeErrorOverDistance(const core::Trajectory& truth, const core::Trajectory& estimate,
                                        double distance_m);
/// j: the first stamp at or past `interval_s` after i (with a millisecond of slack); a gap in the estimate
/// makes longer pairs. REQUIRES > 0.
RelativeError relativeErrorOverTime(const core::Trajectory& truth, const core::Trajectory& estimate,
                                    double interval_s);

/// The pose at a time: that of the nearest stamp within 1 ms, else interpolated between its neighbours. False
/// outside the span (1 ms slack), for an empty trajectory and for a time that is not finite. Stamps must not
/// run back (not checked here). Cost: O(log n).
bool poseAt(const core::Trajectory& trajectory, double time_s, core::Pose2& pose);

}  // namespace slam::metrics
