#include "libslam/mapping/scan_deskewer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/scanmatch/information.h"

namespace slam::mapping {
namespace {

/// What the robot did in a time.
struct RecentMotion {
  core::Pose2 T_previous_robot;
  double period_s;
};

/// The motion up to the scan: the odometry's, else that of the step before where that one had odometry. A
/// motion that is itself from skewed scans would make it worse.
std::optional<RecentMotion> motionUpTo(const StepHistory& history, const lidar::Scan& scan,
                                       const core::Pose2& T_previous_robot, bool has_odometry) {
  if (!history.previous_scan) return std::nullopt;
  const double period_s = scan.time_s - history.previous_scan->time_s;
  if (has_odometry && period_s > 0 && core::isFinite(T_previous_robot))
    return RecentMotion{T_previous_robot, period_s};
  if (history.last_had_odometry && history.last_period_s > 0)
    return RecentMotion{history.T_previous_last, history.last_period_s};
  return std::nullopt;
}

/// Points of both scans, as far as scans are compared.
constexpr scanmatch::ScanPointOptions kSpacing = [] {
  scanmatch::ScanPointOptions options;
  options.max_range_m = 30;
  return options;
}();
/// Odometry's standard deviations over kNominalPeriod_s, and per metre or radian; beyond so many of them it
/// loses its hold.
constexpr double kOdometry_m = 0.02, kOdometry_rad = 0.01, kOdometryShare = 0.1, kOdometryKernel = 2;
/// A match that explains less corrects nothing; one that explains more needs no other start; and another
/// start has to explain so much more.
constexpr double kLeastScore = 0.5, kSurely = 0.9, kStartGain = 0.02;
/// What odometry errs by skews the scan, and the skew the match, by about a tenth: once more leaves a
/// hundredth.
constexpr int kMoreRounds = 1;

/// Of the time between scans: in a longer sweep too much of what the match finds is skew of the scan before,
/// and errors would be handed on from scan to scan.
constexpr double kLongestShare = 0.5;
/// There only whether wheels have slipped is asked, when odometry is so far from how the robot moved before.
constexpr double kApart_m = 0.03, kApart_rad = 0.02, kGainSigmas = 2;
/// Where one has, or nothing explains enough (it slips as the robot begins to turn), every turn is tried from
/// that before to odometry's, and so far beyond them; but none beyond so much in one sweep.
constexpr double kSlip_rad = 0.3, kSlipStep_rad = 0.05, kMostTurn_rad = 1;

/// The last motion, as it goes on.
std::optional<core::Pose2> goingOn(const StepHistory& history, double period_s) {
  if (!(history.last_period_s > 0)) return std::nullopt;
  return core::interpolate({}, history.T_previous_last, period_s / history.last_period_s);
}

/// Two motions that deskew a scan differently.
bool areApart(const core::Pose2& a, const core::Pose2& b) {
  const core::Pose2 T = core::between(a, b);
  return core::hypot(T.x, T.y) > kApart_m || std::abs(T.phi) > kApart_rad;
}

/// Of two shares that as many points explain, by how much one has to be larger not to be so by chance.
double leastGain(double share, std::size_t points) {
  return kStartGain +
         kGainSigmas * std::sqrt(share * (1 - share) / static_cast<double>(std::max<std::size_t>(points, 1)));
}

}  // namespace

/// The motion of which the scan, deskewed by `guess`, tells, and how much of it that explains.
scanmatch::MatchResult ScanDeskewer::matched(const lidar::Scan& deskewed, const core::Pose2& guess,
                                             const scanmatch::PosePrior& odometry) const {
  const auto points = scanmatch::patchPoints(deskewed, kSpacing);
  scanmatch::MatchOptions options;
  options.information_scale = scanmatch::kInformationScale;
  options.prior_kernel = kOdometryKernel;
  scanmatch::MatchResult result;
  result.T_map_robot = guess;
  for (const auto* map : {&coarse_, &fine_})
    result = scanmatch::alignToSurfels(points, *map, result.T_map_robot, odometry, options);
  return result;
}

/// By the motion that odometry gives, or the last one goes on where that explains more (wheels slip); of a
/// short sweep each as the scan before corrects it, of a long one with other turns where neither is enough.
lidar::Scan ScanDeskewer::deskewedByMatch(const StepHistory& history, const lidar::Scan& scan,
                                          const core::Pose2& T_previous_robot, double period_s,
                                          const lidar::Sweep& sweep) {
  lidar::Scan result = lidar::deskewed(scan, T_previous_robot, period_s, sweep);
  const bool is_short = sweep.duration_s <= kLongestShare * period_s;
  const auto goes_on = goingOn(history, period_s);
  if (!is_short && !(goes_on && areApart(*goes_on, T_previous_robot))) return result;
  const auto before = scanmatch::patchPoints(*history.previous_scan, kSpacing);
  for (auto* map : {&coarse_, &fine_}) map->clear({}, kSpacing.max_range_m), map->add(before, {});
  const double root = std::sqrt(std::clamp(period_s, 0.0, 2.0) / scanmatch::kNominalPeriod_s);
  scanmatch::PosePrior odometry;
  odometry.mean = T_previous_robot;
  odometry.information = scanmatch::poseInformation(
      kOdometry_m * root + kOdometryShare * core::hypot(T_previous_robot.x, T_previous_robot.y),
      kOdometry_rad * root + kOdometryShare * std::abs(T_previous_robot.phi));
  auto match = matched(result, T_previous_robot, odometry);
  const auto tryMotion = [&](const core::Pose2& T, double least) {
    lidar::Scan by_it = lidar::deskewed(scan, T, period_s, sweep);
    const auto other = matched(by_it, T, odometry);
    const double gain = is_short ? kStartGain : leastGain(match.score, before.size());
    const bool is_better = other.score > std::max(match.score + gain, least);
    if (is_better) match = other, result = std::move(by_it);
    if (is_better && !is_short) moved_instead_ = match.T_map_robot;
    return is_better;
  };
  const bool is_told_wrong = match.score < kSurely && goes_on && tryMotion(*goes_on, 0);
  if (!is_short && (is_told_wrong || match.score < kLeastScore)) {
    const auto turnOf = [](const core::Pose2& T) {
      return std::clamp(core::wrapToPi(T.phi), -kMostTurn_rad, kMostTurn_rad);
    };
    const double last = turnOf(*goes_on), told = turnOf(T_previous_robot);
    const double first = std::min(last, told) - kSlip_rad, range = std::abs(told - last) + 2 * kSlip_rad;
    for (int step = 0; step * kSlipStep_rad < range; ++step)
      tryMotion({T_previous_robot.x, T_previous_robot.y, first + step * kSlipStep_rad}, kLeastScore);
  }
  for (int round = 0; is_short && match.score > kLeastScore; ++round) {
    result = lidar::deskewed(scan, match.T_map_robot, period_s, sweep);
    if (round == kMoreRounds) break;
    match = matched(result, match.T_map_robot, odometry);
  }
  return result;
}

std::optional<lidar::Scan> ScanDeskewer::deskewed(const StepHistory& history, const lidar::Scan& scan,
                                                  std::optional<lidar::Sweep> sweep,
                                                  const core::Pose2& T_previous_robot, bool has_odometry) {
  moved_instead_.reset();
  if (method_.sweep_s > 0) sweep = lidar::Sweep{method_.sweep_s, method_.sweep_clockwise};
  if (!sweep || !(sweep->duration_s > 0)) return std::nullopt;
  counts_.swept += history.previous_scan.has_value();
  if (!method_.deskew) return std::nullopt;
  const auto motion = motionUpTo(history, scan, T_previous_robot, has_odometry);
  const double since_s = history.previous_scan ? scan.time_s - history.previous_scan->time_s : 0;
  if (!motion && !(unskews_alone_ && since_s > 0)) return std::nullopt;
  ++counts_.set_right;
  if (!motion || !has_odometry) {
    const RecentMotion assumed = motion.value_or(RecentMotion{{}, since_s});
    lidar::Scan result = lidar::deskewed(scan, assumed.T_previous_robot, assumed.period_s, *sweep);
    result.deskewing.is_measured = false;
    return result;
  }
  if (lidar::areOfOneLidar(*history.previous_scan, scan))
    return deskewedByMatch(history, scan, motion->T_previous_robot, motion->period_s, *sweep);
  return lidar::deskewed(scan, motion->T_previous_robot, motion->period_s, *sweep);
}

}  // namespace slam::mapping
