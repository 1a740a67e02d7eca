#include "libslam/calibration/clock_offset.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/random.h"

namespace slam::calibration {
namespace {

constexpr int kReach = 60;  // lags to each side
constexpr double kLag_s = 0.05;
constexpr std::size_t kLags = 2 * kReach + 1;
constexpr std::size_t kBlocks = 40;
constexpr int kResamples = 200;
constexpr double kLargestTurn_rad = 0.6;  // between two scans; more is a mismatch oftener than a turn
constexpr double kLongestStep_s = 2;
constexpr double kLeastTurned_rad = 2, kLeastCorrelation = 0.4, kWidestInterval_s = 0.5;

/// Sums over the steps of one part of the log, per lag.
struct Block {
  std::vector<double> xy = std::vector<double>(kLags), xx = xy;
  double yy = 0;
};

double correlation(const Block& sums, std::size_t lag) {
  const double product = sums.xx[lag] * sums.yy;
  return product > 0 ? sums.xy[lag] / std::sqrt(product) : 0;
}

double lagSeconds(std::size_t lag) {
  return (static_cast<double>(lag) - kReach) * kLag_s;
}

/// Where the correlation is largest, by a parabola through the best lag and its neighbours.
double bestOffset(const Block& sums, std::size_t& best) {
  best = 0;
  for (std::size_t lag = 1; lag < kLags; ++lag)
    if (correlation(sums, lag) > correlation(sums, best)) best = lag;
  if (best == 0 || best == kLags - 1) return lagSeconds(best);
  const double a = correlation(sums, best - 1), b = correlation(sums, best), c = correlation(sums, best + 1);
  const double bend = a - 2 * b + c;
  return lagSeconds(best) + (bend < 0 ? 0.5 * (a - c) / bend * kLag_s : 0);
}

void add(const Block& part, Block& sums) {
  for (std::size_t lag = 0; lag < kLags; ++lag) sums.xy[lag] += part.xy[lag], sums.xx[lag] += part.xx[lag];
  sums.yy += part.yy;
}

/// The odometry's turn over a step at every lag; false where one is missing, so that all lags see the same
/// steps.
bool turnsAt(const OdometryCurve& odometry, const ScanStep& step, std::vector<double>& turns) {
  for (std::size_t lag = 0; lag < kLags; ++lag) {
    const auto from = odometry.at(step.from_s - lagSeconds(lag));
    const auto to = odometry.at(step.to_s - lagSeconds(lag));
    if (!from || !to) return false;
    turns[lag] = to->phi - from->phi;
  }
  return true;
}

}  // namespace

ClockOffset findClockOffset(const std::vector<Stretch>& stretches, const std::string& stream) {
  ClockOffset result;
  std::size_t steps = 0;
  for (const auto& stretch : stretches) steps += stretch.steps.size();
  if (steps == 0) return result;
  const std::size_t block_length = std::max<std::size_t>(steps / kBlocks, 1);
  std::vector<Block> blocks;
  std::vector<double> turns(kLags);
  std::size_t index = 0;
  for (const auto& stretch : stretches) {
    const OdometryCurve odometry(stretch, stream);
    for (const auto& step : stretch.steps) {
      if (index++ % block_length == 0) blocks.emplace_back();
      const double turn = step.T_previous_lidar.phi, duration_s = step.to_s - step.from_s;
      if (!step.is_matched || std::abs(turn) > kLargestTurn_rad) continue;
      if (duration_s <= 0 || duration_s > kLongestStep_s || !turnsAt(odometry, step, turns)) continue;
      auto& block = blocks.back();
      block.yy += turn * turn;
      result.turned_rad += std::abs(turn);
      for (std::size_t lag = 0; lag < kLags; ++lag) {
        block.xy[lag] += turn * turns[lag];
        block.xx[lag] += turns[lag] * turns[lag];
      }
    }
  }
  Block all;
  for (const auto& block : blocks) add(block, all);
  std::size_t best = 0;
  const double offset_s = bestOffset(all, best);
  result.correlation = correlation(all, best);
  result.correlation_at_zero = correlation(all, kReach);

  core::RandomStream random(1, "clock offset");
  std::vector<double> samples;
  for (int i = 0; i < kResamples; ++i) {
    Block sums;
    for (std::size_t k = 0; k < blocks.size(); ++k) add(blocks[random.below(blocks.size())], sums);
    std::size_t ignored = 0;
    samples.push_back(bestOffset(sums, ignored));
  }
  std::sort(samples.begin(), samples.end());
  result.offset_s = {offset_s, std::min(samples[kResamples / 40], offset_s),
                     std::max(samples[kResamples - 1 - kResamples / 40], offset_s)};
  result.is_observable = result.turned_rad >= kLeastTurned_rad && result.correlation >= kLeastCorrelation &&
                         best != 0 && best != kLags - 1 && result.offset_s.width() <= kWidestInterval_s;
  return result;
}

}  // namespace slam::calibration
