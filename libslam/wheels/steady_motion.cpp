#include "libslam/wheels/steady_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"

namespace slam::wheels {
namespace {

using core::Pose2;

/// Moves of which the middle one goes on.
constexpr size_t kMoves = 5;
/// A step is no more times as long as another, whatever the stamps say.
constexpr double kMostTimes = 5;
/// Of the newest step in the mean of what the two readings are off by, and the most that one counts; a radian
/// counts as a metre.
constexpr double kGain = 0.05, kMost = 1;

/// A motion at the same speed and turn rate, for `times` the time.
Pose2 goneOn(const Pose2& T, double times) {
  // Along an arc the chord turns by half of the turn.
  const double half = T.phi / 2;
  const double length = std::abs(half) > 1e-9 ? core::sin(times * half) / core::sin(half) : times;
  const double turn = (times - 1) * half, c = core::cos(turn), s = core::sin(turn);
  return {length * (c * T.x - s * T.y), length * (s * T.x + c * T.y), core::wrapToPi(times * T.phi)};
}

}  // namespace

Pose2 SteadyMotion::next(double since_s) {
  since_s_ = since_s;
  if (last_.empty()) return {};
  std::vector<double> x, y;
  const auto middle = [&](const auto& timesOf) -> Pose2 {
    x.clear(), y.clear();
    Pose2 T;
    for (const Motion& one : last_) {
      T = goneOn(one.T_previous_robot, timesOf(one));
      x.push_back(T.x), y.push_back(T.y);
    }
    return {core::middleValue(x), core::middleValue(y), T.phi};
  };
  expected_[0] = middle(
      [&](const Motion& one) { return std::clamp(since_s / one.since_s, 1 / kMostTimes, kMostTimes); });
  expected_[1] = middle([](const Motion&) { return 1.0; });
  return expected_[goesByTime() ? 0 : 1];
}

void SteadyMotion::note(const Pose2& T) {
  if (!std::isfinite(T.x) || !std::isfinite(T.y) || !std::isfinite(T.phi) || !(since_s_ > 0)) return;
  for (size_t i = 0; i < off_.size() && !last_.empty(); ++i) {
    const Pose2& expected = expected_[i];
    const double off = core::distance(expected, T) + std::abs(core::angleDifference(expected.phi, T.phi));
    off_[i] += kGain * (std::min(off, kMost) - off_[i]);
  }
  if (last_.size() == kMoves) last_.pop_front();
  last_.push_back({T, since_s_});
}

}  // namespace slam::wheels
