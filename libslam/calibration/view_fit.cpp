#include "libslam/calibration/view_fit.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/random.h"
#include "libslam/odometry/planar_fit.h"

namespace slam::calibration {
namespace {

constexpr double kApart_m = 0.5, kLargestTurn_rad = 1;
constexpr std::array<double, 11> kCoarse = {0.4, 0.5, 2.0 / 3, 0.75, 0.85, 1, 1.15, 4.0 / 3, 1.5, 2, 2.5};
constexpr std::array<double, 6> kFine = {0.88, 0.93, 0.97, 1.03, 1.07, 1.13};
constexpr std::size_t kFewestPairs = 20;
constexpr int kResamples = 200;
/// The best factor must beat the ones half and double of it by this much.
constexpr double kClearly = 0.05;

lidar::Scan spread(lidar::Scan scan, double factor) {
  scan.first_angle_rad *= factor;
  scan.step_rad *= factor;
  return scan;
}

/// 1 where the readings would go round more than once.
double costOf(const lidar::Scan& from, const lidar::Scan& to, const core::Pose2& T_from_to, double factor) {
  if (static_cast<double>(from.ranges_m.size() - 1) * from.step_rad * factor > 2 * core::kPi) return 1;
  odometry::PlanarFitOptions options;
  options.first_scale_m = 0.1;
  options.gate_m = 0.5;
  const core::Pose2 guess{T_from_to.x, T_from_to.y, T_from_to.phi * factor};
  return odometry::fitPlanarMotion(odometry::findLocalLines(spread(from, factor)),
                                   odometry::findLocalLines(spread(to, factor)), guess, options)
      .cost;
}

/// Where a parabola through the costs about the best factor is lowest, by least squares over its neighbours
/// within `reach`. nullopt where it is no minimum.
std::optional<double> lowest(const std::vector<ViewFit::Candidate>& candidates, double best, double reach) {
  double s[5] = {}, t[3] = {};
  for (const auto& candidate : candidates) {
    const double u = (candidate.factor - best) / best;
    if (std::abs(u) > reach) continue;
    double power = 1;
    for (int i = 0; i < 5; ++i, power *= u) {
      s[i] += power;
      if (i < 3) t[i] += power * candidate.cost;
    }
  }
  // Cramer's rule on the normal equations of c + b u + a u^2; the minimum is at -b / 2a.
  const auto det = [](double a, double b, double c, double d, double e, double f, double g, double h,
                      double i) { return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g); };
  const double whole = det(s[0], s[1], s[2], s[1], s[2], s[3], s[2], s[3], s[4]);
  const double b = det(s[0], t[0], s[2], s[1], t[1], s[3], s[2], t[2], s[4]);
  const double a = det(s[0], s[1], t[0], s[1], s[2], t[1], s[2], s[3], t[2]);
  if (whole == 0 || a / whole <= 0) return std::nullopt;
  return best * std::clamp(1 - b / (2 * a), 1 - reach, 1 + reach);
}

}  // namespace

ViewPairs::ViewPairs(std::uint64_t scans) : spacing_(scans / (2 * kMostPairs)) {}

void ViewPairs::addScan(const lidar::Scan& scan, const ScanStep* step) {
  ++since_pair_;
  if (pairs_.size() >= kMostPairs) return;
  if (!step || !step->is_matched) {
    from_ = scan;
    T_from_here_ = {};
    return;
  }
  T_from_here_ = T_from_here_ * step->T_previous_lidar;
  const double moved_m = core::hypot(T_from_here_.x, T_from_here_.y);
  const bool is_turned = std::abs(T_from_here_.phi) > kLargestTurn_rad;
  if (moved_m < kApart_m && !is_turned) return;
  if (!is_turned && since_pair_ >= spacing_ && from_ && from_->ranges_m.size() == scan.ranges_m.size()) {
    pairs_.push_back({*from_, scan, T_from_here_});
    since_pair_ = 0;
  }
  from_ = scan;
  T_from_here_ = {};
}

ViewFit ViewPairs::fit() const {
  ViewFit result;
  result.pairs = pairs_.size();
  if (pairs_.size() < kFewestPairs) return result;
  std::vector<std::vector<double>> costs;  // per candidate and pair
  const auto tryFactor = [&](double factor) {
    costs.emplace_back();
    double sum = 0;
    for (const auto& pair : pairs_) {
      costs.back().push_back(costOf(pair.from, pair.to, pair.T_from_to, factor));
      sum += costs.back().back();
    }
    result.candidates.push_back({factor, sum / static_cast<double>(pairs_.size())});
  };
  const auto cheaper = [](const auto& a, const auto& b) { return a.cost < b.cost; };
  for (const double factor : kCoarse) tryFactor(factor);
  const auto coarse = *std::min_element(result.candidates.begin(), result.candidates.end(), cheaper);
  const std::size_t coarse_ones = result.candidates.size();
  for (const double factor : kFine) tryFactor(coarse.factor * factor);
  const auto best = *std::min_element(result.candidates.begin(), result.candidates.end(), cheaper);
  constexpr double kParabola = 0.075;
  for (const double offset : {-0.05, -0.015, 0.015, 0.05}) tryFactor(best.factor * (1 + offset));

  const auto minimum = lowest(result.candidates, best.factor, kParabola);
  core::RandomStream random(1, "field of view");
  std::vector<double> samples;
  for (int i = 0; i < kResamples; ++i) {
    auto resampled = result.candidates;
    for (auto& candidate : resampled) candidate.cost = 0;
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const std::size_t pair = random.below(pairs_.size());
      for (std::size_t c = 0; c < costs.size(); ++c) resampled[c].cost += costs[c][pair];
    }
    samples.push_back(lowest(resampled, best.factor, kParabola).value_or(best.factor));
  }
  std::sort(samples.begin(), samples.end());
  const double value = minimum.value_or(best.factor);
  result.factor = {value, std::min(samples[kResamples / 40], value),
                   std::max(samples[kResamples - 1 - kResamples / 40], value)};
  bool is_clear = minimum.has_value();
  for (std::size_t c = 0; c < coarse_ones; ++c) {
    const auto& candidate = result.candidates[c];
    const double ratio = candidate.factor / best.factor;
    if ((ratio < 0.8 || ratio > 1.25) && candidate.cost < best.cost + kClearly) is_clear = false;
  }
  result.is_observable = is_clear;
  std::sort(result.candidates.begin(), result.candidates.end(),
            [](const auto& a, const auto& b) { return a.factor < b.factor; });
  return result;
}

}  // namespace slam::calibration
