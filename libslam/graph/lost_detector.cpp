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
/// What is believed of streaks before anything was seen counts as so many looks.
constexpr double kStreaksBefore = 6;

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

/// The same with each as variable as it is: Student's t of 3 degrees of freedom, for the tails are long.
double LostDetector::ratioOfTails(double share, const Learnt& well) const {
  if (!std::isfinite(share) || !(wrong_.mean - well.mean > kLeastGap)) return 0;
  const auto logDensity = [share](const Learnt& learnt) {
    const double variance = std::max(learnt.variance, kLeastVariance), off = share - learnt.mean;
    return -0.5 * core::log(variance) - 2 * core::log(1 + off * off / (3 * variance));
  };
  return std::clamp(logDensity(wrong_) - logDensity(well), -kMostPerLook, kMostPerLook);
}

/// A look, made of all that count as one: whether it speaks for another place, and did when the one before
/// had.
void LostDetector::countStreak(bool is_high, double news) {
  look_news_ += news;
  if (is_high) high_news_ += news;
  if (look_news_ < 1) return;
  const bool high = 2 * high_news_ > look_news_;
  if (was_high_) {
    undecided_.looks += 1;
    if (high) undecided_.high += 1;
  }
  if (evidence_ <= -kUnbroken) learnStreaks();
  was_high_ = high;
  look_news_ = high_news_ = 0;
}

/// The most that one look says for another place, after one that did.
double LostDetector::mostInStreak() const {
  const double before = kStreaksBefore * core::exp(-kMostPerLook);
  return -core::log((streaks_.high + before) / (streaks_.looks + kStreaksBefore));
}

/// All was well, whatever these looks said.
void LostDetector::learnStreaks() {
  streaks_.looks += undecided_.looks, streaks_.high += undecided_.high;
  undecided_ = {};
}

void LostDetector::dismiss() {
  dismissed_ += 1;
  learnStreaks();
  restart();
}

void LostDetector::decide() {
  if (evidence_ >= kToldEnough) evidence_ = std::max(evidence_, kLost);
}

void LostDetector::restart() {
  evidence_ = -kUnbroken;
  undecided_ = {};
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
  // Two breaks are a glitch rather than two kidnappings.
  const double broken = ratioOfTails(now.broken, unbroken_);
  const bool has_ended = isInDoubt() && broken >= kMostPerLook;
  double says = ratio(now.contradicted, well_);
  const double own = ratioOfTails(now.contradicted, well_);
  says = std::max(says, own / (1 + odd_));
  // What is mostly explained speaks against it, whatever the rest says.
  if (!now.may_be_lost) says = std::min(says, -0.5 * kMostPerLook);
  const bool is_high = says > 0;
  if (was_high_) says = std::min(says, mostInStreak());
  says *= news * std::min(std::isfinite(now.telling) ? now.telling / kTelling : 0, 1.0);
  // After the break the scans of a robot that was kidnapped fit one another; among people who walk about they
  // do not.
  if (says > 0 && evidence_ > begins_now && std::isfinite(now.broken))
    says *= std::clamp(-broken / kMostPerLook, 0.0, 1.0);
  evidence_ = std::max(std::max(evidence_, begins_now) + says, -kUnbroken);
  if (has_ended && !is_high) evidence_ = std::min(evidence_, kDoubt);
  for (double* count : {&streaks_.looks, &streaks_.high, &odd_}) *count *= core::exp(-news / kForgotten);
  countStreak(is_high, news);
  // What speaks for another place is not learnt as what is well.
  if (isInDoubt()) return;
  if (own > 0) odd_ += news;
  if (std::isfinite(now.contradicted)) well_.add(now.contradicted, news, kMostLooks);
  if (std::isfinite(now.broken)) unbroken_.add(now.broken, news, kMostLooks);
}

}  // namespace slam::graph
