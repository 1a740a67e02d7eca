#include "libslam/metrics/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/numbers.h"

namespace slam::metrics {
namespace {

using core::kNaN;
// 1 ms, and half a microsecond more because a double holds an epoch time of 2e9 s only to 0.24 us.
constexpr double kSameStamp_s = 1.0005e-3;
// Far below any sensor's noise and far above the rounding of a sum of steps.
constexpr double kSameDistance_m = 1e-6;

/// The poses of both at the stamps of the estimate that have a truth.
struct MatchedPoses {
  std::vector<double> time_s;
  std::vector<core::Pose2> truth, estimate;
};

void requireOrderedStamps(const core::Trajectory& trajectory, const std::string& name) {
  for (size_t i = 1; i < trajectory.size(); ++i)
    if (trajectory[i].time_s < trajectory[i - 1].time_s)
      throw core::ContractError(name + ": stamp " + std::to_string(i) + " runs back");
}

bool stampsAreFinite(const core::Trajectory& trajectory) {
  return std::all_of(trajectory.begin(), trajectory.end(),
                     [](const core::StampedPose& p) { return std::isfinite(p.time_s); });
}

bool posesAreFinite(const core::Trajectory& trajectory) {
  return std::all_of(trajectory.begin(), trajectory.end(),
                     [](const core::StampedPose& p) { return core::isFinite(p.pose); });
}

/// False where a comparison would mean nothing: its statistics stay NaN.
bool comparable(const core::Trajectory& truth, const core::Trajectory& estimate) {
  return stampsAreFinite(truth) && posesAreFinite(truth) && stampsAreFinite(estimate);
}

MatchedPoses match(const core::Trajectory& truth, const core::Trajectory& estimate) {
  requireOrderedStamps(truth, "truth");
  requireOrderedStamps(estimate, "estimate");
  MatchedPoses matched;
  for (const auto& estimated : estimate) {
    core::Pose2 true_pose;
    if (!poseAt(truth, estimated.time_s, true_pose)) continue;
    matched.time_s.push_back(estimated.time_s);
    matched.truth.push_back(true_pose);
    matched.estimate.push_back(estimated.pose);
  }
  return matched;
}

core::Point2 centroid(const std::vector<core::Pose2>& poses) {
  core::Point2 sum;
  for (const auto& pose : poses) sum.x += pose.x, sum.y += pose.y;
  const auto n = static_cast<double>(poses.size());
  return {sum.x / n, sum.y / n};
}

/// Length driven along `trajectory` from its start to each of the given times, which lie within its span and
/// do not run back.
std::vector<double> drivenAt(const core::Trajectory& trajectory, const std::vector<double>& times_s,
                             const std::vector<core::Pose2>& poses) {
  std::vector<double> driven_m;
  double to_vertex_m = 0;
  size_t next = 0;  // first vertex later than the time asked for
  for (size_t i = 0; i < times_s.size(); ++i) {
    for (; next < trajectory.size() && trajectory[next].time_s <= times_s[i]; ++next)
      if (next > 0) to_vertex_m += core::distance(trajectory[next - 1].pose, trajectory[next].pose);
    const double beyond_m = next == 0 ? 0 : core::distance(trajectory[next - 1].pose, poses[i]);
    driven_m.push_back(to_vertex_m + beyond_m);
  }
  return driven_m;
}

/// Pairs every i with the first j at which `progress` has grown by `step`.
RelativeError relativeError(const MatchedPoses& matched, const std::vector<double>& progress, double step,
                            double slack) {
  std::vector<double> translations_m, rotations_rad;
  size_t j = 0;
  for (size_t i = 0; i < progress.size(); ++i) {
    while (j < progress.size() && progress[j] - progress[i] < step - slack) ++j;
    if (j == progress.size()) break;
    const auto true_motion = core::between(matched.truth[i], matched.truth[j]);
    const auto estimated_motion = core::between(matched.estimate[i], matched.estimate[j]);
    const auto error = core::between(true_motion, estimated_motion);
    translations_m.push_back(core::hypot(error.x, error.y));
    rotations_rad.push_back(std::abs(error.phi));
  }
  return {errorStatistics(translations_m), errorStatistics(rotations_rad)};
}

void requirePositive(double value, const std::string& name) {
  if (!(value > 0 && std::isfinite(value))) throw core::ContractError(name + " must be finite and above 0");
}

}  // namespace

bool poseAt(const core::Trajectory& trajectory, double time_s, core::Pose2& pose) {
  if (trajectory.empty() || !std::isfinite(time_s)) return false;
  const auto after = std::lower_bound(trajectory.begin(), trajectory.end(), time_s,
                                      [](const core::StampedPose& p, double t) { return p.time_s < t; });
  const auto before = after == trajectory.begin() ? after : after - 1;
  const double to_after_s =
      after == trajectory.end() ? std::numeric_limits<double>::infinity() : after->time_s - time_s;
  const double to_before_s = std::abs(time_s - before->time_s);
  if (std::min(to_after_s, to_before_s) <= kSameStamp_s) {
    pose = to_after_s <= to_before_s ? after->pose : before->pose;
    return true;
  }
  if (after == trajectory.begin() || after == trajectory.end()) return false;
  pose = core::interpolate(before->pose, after->pose, to_before_s / (after->time_s - before->time_s));
  return true;
}

core::Pose2 alignPositions(const std::vector<core::Pose2>& truth, const std::vector<core::Pose2>& estimate) {
  if (truth.empty() || truth.size() != estimate.size())
    throw core::ContractError("alignPositions: needs two lists of equal length, at least 1");
  const auto q0 = centroid(truth), p0 = centroid(estimate);
  // Umeyama 1991, eqs. 38-42: in the plane the rotation that maximises trace(R * covariance) is the angle of
  // (sum p.q, sum p x q), positions p and q taken from their centroids.
  double dot = 0, cross = 0, truth_spread = 0, estimate_spread = 0;
  for (size_t i = 0; i < truth.size(); ++i) {
    const double qx = truth[i].x - q0.x, qy = truth[i].y - q0.y;
    const double px = estimate[i].x - p0.x, py = estimate[i].y - p0.y;
    dot += px * qx + py * qy;
    cross += px * qy - py * qx;
    truth_spread += qx * qx + qy * qy;
    estimate_spread += px * px + py * py;
  }
  if (!std::isfinite(dot) || !std::isfinite(cross)) return {kNaN, kNaN, kNaN};
  // Below these the angle is that of rounding errors: positions within a micrometre of their centroid, or
  // sums that cancel to the last few digits.
  const double n = static_cast<double>(truth.size());
  const bool open = std::min(truth_spread, estimate_spread) <= n * kSameDistance_m * kSameDistance_m ||
                    core::hypot(dot, cross) <= 1e-12 * std::sqrt(truth_spread * estimate_spread);
  const double angle =
      open ? core::angleDifference(truth.front().phi, estimate.front().phi) : core::atan2(cross, dot);
  const auto rotated_p0 = core::Pose2{0, 0, angle} * p0;
  return {q0.x - rotated_p0.x, q0.y - rotated_p0.y, angle};
}

namespace {

core::Pose2 aligned(const MatchedPoses& matched, Align align, const core::Pose2& T_truth_map) {
  switch (align) {
    case Align::kNone:
      return T_truth_map;
    case Align::kFirst:
      return matched.truth.front() * core::inverse(matched.estimate.front());
    default:
      return alignPositions(matched.truth, matched.estimate);
  }
}

}  // namespace

TrajectoryError trajectoryError(const core::Trajectory& truth, const core::Trajectory& estimate, Align align,
                                const core::Pose2& T_truth_map) {
  TrajectoryError result;
  result.T_truth_estimate = {kNaN, kNaN, kNaN};
  const auto matched = match(truth, estimate);
  result.unmatched = estimate.size() - matched.truth.size();
  if (matched.truth.empty() || !comparable(truth, estimate)) return result;

  result.T_truth_estimate = aligned(matched, align, T_truth_map);
  std::vector<double> positions_m, headings_rad;
  for (size_t i = 0; i < matched.truth.size(); ++i) {
    const auto aligned = result.T_truth_estimate * matched.estimate[i];
    positions_m.push_back(core::distance(aligned, matched.truth[i]));
    headings_rad.push_back(std::abs(core::angleDifference(aligned.phi, matched.truth[i].phi)));
  }
  result.position_m = errorStatistics(positions_m);
  result.heading_rad = errorStatistics(headings_rad);
  return result;
}

RelativeError relativeErrorOverDistance(const core::Trajectory& truth, const core::Trajectory& estimate,
                                        double distance_m) {
  requirePositive(distance_m, "distance_m");
  const auto matched = match(truth, estimate);
  if (!comparable(truth, estimate)) return {};
  return relativeError(matched, drivenAt(truth, matched.time_s, matched.truth), distance_m, kSameDistance_m);
}

RelativeError relativeErrorOverTime(const core::Trajectory& truth, const core::Trajectory& estimate,
                                    double interval_s) {
  requirePositive(interval_s, "interval_s");
  const auto matched = match(truth, estimate);
  if (!comparable(truth, estimate)) return {};
  return relativeError(matched, matched.time_s, interval_s, kSameStamp_s);
}

}  // namespace slam::metrics
