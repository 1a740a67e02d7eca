#include "libslam/calibration/sweep_fit.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/middle_value.h"
#include "libslam/core/random.h"
#include "libslam/odometry/planar_fit.h"

namespace slam::calibration {
namespace {

constexpr double kLeastChange_radps = 0.25;  // of the turning between two scans
constexpr std::size_t kFewestPairs = 8;
constexpr int kSteps = 10;  // candidates on each side of none, up to the whole period
constexpr int kResamples = 200;
/// The interval must not be wider than this share of the period.
constexpr double kWidest = 0.4;
/// The parabola is laid through candidates this near to the best, in steps.
constexpr int kReach = 3;

/// Where a parabola through the costs about the lowest is lowest, in steps from the first. nullopt where that
/// is no minimum.
std::optional<double> lowest(const std::vector<double>& costs) {
  const auto best = static_cast<int>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  const int low = std::max(best - kReach, 0),
            high = std::min(best + kReach, static_cast<int>(costs.size()) - 1);
  // Least squares of c + b u + a u^2 by orthogonal polynomials: u is centred, and evenly spaced.
  const double centre = 0.5 * (low + high), count = high - low + 1;
  double s2 = 0, s4 = 0, mean = 0, slope = 0, bend = 0;
  for (int i = low; i <= high; ++i) {
    const double u = i - centre, cost = costs[static_cast<size_t>(i)];
    s2 += u * u, s4 += u * u * u * u, mean += cost, slope += u * cost, bend += u * u * cost;
  }
  const double a = (bend - s2 * mean / count) / (s4 - s2 * s2 / count), b = slope / s2;
  if (!(a > 0)) return std::nullopt;
  return std::clamp(centre - b / (2 * a), static_cast<double>(low), static_cast<double>(high));
}

}  // namespace

SweepPairs::SweepPairs(std::uint64_t scans) : spacing_(scans / (4 * kMostPairs)) {}

void SweepPairs::addScan(const lidar::Scan& scan, const std::optional<core::Pose2>& T_previous_robot) {
  ++since_pair_;
  const double period_s = previous_scan_ ? scan.time_s - previous_scan_->time_s : 0;
  std::optional<Moving> moving;
  if (T_previous_robot && period_s > 0) moving = Moving{scan, *T_previous_robot, period_s};
  if (moving && previous_ && pairs_.size() < kMostPairs && since_pair_ > spacing_ &&
      previous_->scan.ranges_m.size() == scan.ranges_m.size()) {
    const double change_radps =
        std::abs(core::wrapToPi(moving->T_previous_robot.phi) / moving->period_s -
                 core::wrapToPi(previous_->T_previous_robot.phi) / previous_->period_s);
    if (change_radps > kLeastChange_radps) {
      pairs_.push_back({*previous_, *moving});
      since_pair_ = 0;
    }
  }
  previous_ = std::move(moving);
  previous_scan_ = scan;
}

double SweepPairs::costOf(const Pair& pair, double duration_s) const {
  const lidar::Sweep sweep{std::abs(duration_s), duration_s < 0};
  const auto deskew = [&](const Moving& moving) {
    return odometry::findLocalLines(
        lidar::deskewed(moving.scan, moving.T_previous_robot, moving.period_s, sweep));
  };
  const core::Pose2& mount = pair.to.scan.T_robot_lidar;
  const core::Pose2 T_from_to = core::inverse(mount) * pair.to.T_previous_robot * mount;
  odometry::PlanarFitOptions options;
  options.first_scale_m = 0.1;
  options.gate_m = 0.5;
  return odometry::fitPlanarMotion(deskew(pair.from), deskew(pair.to), T_from_to, options).cost;
}

SweepFit SweepPairs::fit() const {
  SweepFit result;
  result.pairs = pairs_.size();
  if (pairs_.size() < kFewestPairs) return result;
  std::vector<double> periods_s;
  for (const auto& pair : pairs_) periods_s.push_back(pair.to.period_s);
  const double period_s = core::middleValue(std::move(periods_s));
  constexpr std::size_t kCandidates = 2 * kSteps + 1;
  std::vector<std::vector<double>> costs(kCandidates);  // per candidate and pair
  std::vector<double> sums(kCandidates, 0);
  for (std::size_t c = 0; c < kCandidates; ++c)
    for (const auto& pair : pairs_) {
      costs[c].push_back(costOf(pair, period_s * (static_cast<double>(c) / kSteps - 1)));
      sums[c] += costs[c].back();
    }
  const auto best = lowest(sums);
  core::RandomStream random(1, "sweep");
  std::vector<double> samples;
  for (int i = 0; i < kResamples; ++i) {
    std::vector<double> resampled(kCandidates, 0);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const std::size_t pair = random.below(pairs_.size());
      for (std::size_t c = 0; c < kCandidates; ++c) resampled[c] += costs[c][pair];
    }
    if (const auto sample = lowest(resampled)) samples.push_back(*sample);
  }
  if (!best || samples.size() < kResamples * 9 / 10) return result;
  std::sort(samples.begin(), samples.end());
  const auto inSeconds = [&](double step) { return period_s * (step / kSteps - 1); };
  result.duration_s = {
      inSeconds(*best), std::min(inSeconds(samples[samples.size() / 40]), inSeconds(*best)),
      std::max(inSeconds(samples[samples.size() - 1 - samples.size() / 40]), inSeconds(*best))};
  result.is_observable = result.duration_s.width() < kWidest * period_s;
  return result;
}

}  // namespace slam::calibration
