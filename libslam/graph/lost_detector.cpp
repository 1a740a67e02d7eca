#include "libslam/graph/lost_detector.h"

#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"

namespace slam::graph {
namespace {

/// Older looks are forgotten so that so many count.
constexpr double kMostLooks = 500, kMostWrong = 100;
/// A scan of which the map knows less than this share says less, in proportion.
constexpr double kTelling = 0.3;
/// Wrong places must contradict this much more than the right one, or they cannot be told.
constexpr double kLeastGap = 0.05;
constexpr double kLeastVariance = 1e-3;

}  // namespace

void LostDetector::Learnt::add(double value, double its_weight, double most_weight) {
  weight = std::min(weight + its_weight, most_weight);
  const double step = its_weight / weight, off = value - mean;
  mean += step * off;
  variance = (1 - step) * (variance + step * off * off);
}

void LostDetector::learnWrong(double contradicted) {
  if (std::isfinite(contradicted)) wrong_.add(std::clamp(contradicted, 0.0, 1.0), 1, kMostWrong);
}

/// Log likelihood of a share where the robot is not, over where it is well; within kMostPerLook. Both vary
/// alike here, as the more variable of them does: the tails of what is well are long.
double LostDetector::ratio(double share, const Learnt& well) const {
  const double gap = wrong_.mean - well.mean;
  if (!std::isfinite(share) || !(gap > kLeastGap)) return 0;
  const double variance = std::max({well.variance, wrong_.variance, kLeastVariance});
  return std::clamp(gap / variance * (share - 0.5 * (wrong_.mean + well.mean)), -kMostPerLook, kMostPerLook);
}

void LostDetector::dismiss() {
  dismissed_ += 1;
  restart();
}

void LostDetector::look(const Look& now) {
  const double passed_s = has_time_ ? std::max(now.time_s - last_time_s_, 0.0) : kLook_s;
  last_time_s_ = now.time_s;
  has_time_ = true;
  const double news = std::min(1.0, passed_s / kLook_s + now.moved_m / kLook_m);
  const double unbroken = std::clamp(-ratio(now.broken, unbroken_) / kMostPerLook, 0.0, 1.0);
  dismissed_ *= core::exp(-news / kForgotten);
  const double begins_now =
      now.may_be_lost && std::isfinite(now.broken)
          ? -std::min(kUnbroken, std::max(kUnbroken * unbroken, kPerDismissed * dismissed_))
          : -kUnbroken;
  double says = ratio(now.contradicted, well_);
  // What is mostly explained speaks against it, whatever the rest says.
  if (!now.may_be_lost) says = std::min(says, -0.5 * kMostPerLook);
  says *= news * std::min(std::isfinite(now.telling) ? now.telling / kTelling : 0, 1.0);
  // After the break the scans of a robot that was kidnapped fit one another; among people who walk about they
  // do not.
  if (says > 0 && evidence_ > begins_now && std::isfinite(now.broken))
    says *= 1 - std::clamp(now.broken / std::max(wrong_.mean, kLeastGap), 0.0, 1.0);
  evidence_ = std::max(std::max(evidence_, begins_now) + says, -kUnbroken);
  // What speaks for another place is not learnt as what is well.
  if (isInDoubt()) return;
  if (std::isfinite(now.contradicted)) well_.add(now.contradicted, news, kMostLooks);
  if (std::isfinite(now.broken)) unbroken_.add(now.broken, news, kMostLooks);
}

}  // namespace slam::graph
