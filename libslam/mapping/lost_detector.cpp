#include "libslam/mapping/lost_detector.h"

#include <algorithm>
#include <cmath>

namespace slam::mapping {
namespace {

/// Older looks are forgotten so that so many count.
constexpr double kMostLooks = 500, kMostWrong = 100;
/// A scan of which the map knows less than this share says less, in proportion.
constexpr double kTelling = 0.3;
constexpr double kLeastShare = 0.005, kMostShare = 0.98;
/// Wrong places must contradict this much more than the right one, or they cannot be told.
constexpr double kLeastGap = 0.05;
constexpr double kMostTrials = 30;

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

void LostDetector::look(double time_s, double moved_m, double contradicted, double telling,
                        bool may_be_lost) {
  const double passed_s = has_time_ ? std::max(time_s - last_time_s_, 0.0) : kLook_s;
  last_time_s_ = time_s;
  has_time_ = true;
  if (!std::isfinite(contradicted) || !std::isfinite(telling)) return;
  const double news = std::min(1.0, passed_s / kLook_s + moved_m / kLook_m);
  const double share = std::clamp(contradicted, kLeastShare, kMostShare);
  const double p0 = std::clamp(well_.mean, kLeastShare, kMostShare),
               p1 = std::clamp(wrong_.mean, kLeastShare, kMostShare);
  double ratio = 0;
  if (p1 > p0 + kLeastGap) {
    const double trials = std::min(p0 * (1 - p0) / std::max(well_.variance, 1e-6), kMostTrials);
    ratio = trials * (share * std::log(p1 / p0) + (1 - share) * std::log((1 - p1) / (1 - p0)));
  }
  if (!may_be_lost) ratio = std::min(ratio, 0.0);
  last_ = news * std::min(telling / kTelling, 1.0) * std::clamp(ratio, -kMostPerLook, kMostPerLook);
  evidence_ = std::max(evidence_ + last_, 0.0);
  // What speaks for another place is not learnt as what is well.
  if (evidence_ < kDoubt) well_.add(contradicted, news, kMostLooks);
}

}  // namespace slam::mapping
