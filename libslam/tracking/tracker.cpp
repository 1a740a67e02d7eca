#include "libslam/tracking/tracker.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/scanmatch/information.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

/// In standard deviations of odometry: a match farther from it has let it go.
constexpr double kLetGo = 3;
/// Two scans that contradict each other by more than this share after their own motion do not tell it.
constexpr double kBrokenMotion = 0.3;
/// Odometry's errors are taken as normal to so many standard deviations, and with the tails of Cauchy's
/// distribution beyond.
constexpr double kTail = 2;
/// Standard deviation of a heading about which odometry is not believed.
double looseTurn(double sigma_turn_rad) {
  return 3 * sigma_turn_rad + 0.05;
}
/// What odometry with a step's standard deviations holds against a pose where it has another, in nats.
double heldAgainst(const Pose2& T, const Pose2& T_odometry, double sigma_xy_m, double sigma_turn_rad) {
  const double off = core::distance(T, T_odometry) / sigma_xy_m,
               turned = core::angleDifference(T.phi, T_odometry.phi) / sigma_turn_rad;
  return core::log1p((off * off + turned * turned) / (kTail * kTail));
}

}  // namespace

Tracker::Tracker(keyframes::KeyframeMap& map)
    : map_(&map), options_(&map.options()), motion_(map), around_(map), unskewer_(map) {}

Expected Tracker::expect(const Pose2& T_map_before, const Pose2& T_previous_robot, bool has_odometry) const {
  Expected e;
  e.step = motion_.predict(T_previous_robot, has_odometry);
  e.has_odometry = has_odometry;
  const Pose2& increment = e.step.T_previous_robot;
  e.T_before = T_map_before;
  e.predicted = e.T_before * increment;
  // Some robots count backwards motion forwards, and turns as they are.
  e.backwards = e.T_before * Pose2{-increment.x, -increment.y, increment.phi};
  e.by_wheels = by_wheels_.value_or(e.T_before) * increment;
  return e;
}

/// What odometry holds against a pose, in nats.
double Tracker::unlikely(const Pose2& T, const Expected& e) const {
  const auto by = [&](const Pose2& T_odometry) {
    return heldAgainst(T, T_odometry, e.step.sigma_xy_m, e.step.sigma_turn_rad);
  };
  const double held = std::min(by(e.predicted), motion_.againstBackwards() + by(e.backwards));
  return by_wheels_ ? std::min(held, by(e.by_wheels)) : held;
}

/// How far the scan before contradicts a pose: from where that was matched, or where wheels have it.
double Tracker::brokenAt(const Pose2& T, const std::vector<PatchPoint>& points, const Expected& e) const {
  const double matched = motion_.brokenBy(points, core::between(e.T_before, T));
  return by_wheels_ ? std::min(matched, motion_.brokenBy(points, core::between(*by_wheels_, T))) : matched;
}

/// Whether scan, map and the scan before say more for a match than odometry says against it.
bool Tracker::isBetter(const MatchResult& other, const MatchResult& than, double least_gain,
                       const std::vector<PatchPoint>& points, const Expected& e) const {
  const double against = unlikely(other.T_map_robot, e) - unlikely(than.T_map_robot, e);
  const double least = std::max(least_gain, against / keyframes::kNatsPerScan);
  const double gained = around_.gain(points, other.T_map_robot, than.T_map_robot);
  const double less_broken = brokenAt(than.T_map_robot, points, e) - brokenAt(other.T_map_robot, points, e);
  if (other.score >= options_->recover_score) return gained + std::max(less_broken, 0.0) > least;
  // Wheels are worth more than an explanation of less than half.
  if (e.has_odometry && around_.toldScore(points, other.T_map_robot) < options_->lost_score) return false;
  return gained + less_broken > least;
}

Tracker::Match Tracker::match(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                              const Expected& e) {
  const auto [T_step, sigma_xy, sigma_turn] = e.step;
  const Start start = bestStart(scan, points, e);
  PosePrior prior;
  prior.mean = e.predicted;
  prior.information = scanmatch::poseInformation(sigma_xy, sigma_turn);
  MatchResult result =
      keyframes::match(points, around_.maps(), e.predicted, prior, options_->odometry_kernel, true);
  bool is_dropped = false;
  if (core::distance(result.T_map_robot, e.predicted) > kLetGo * sigma_xy) {
    // Odometry is let go for a better match only, not along a corridor that holds nothing.
    const auto held = keyframes::match(points, around_.maps(), e.predicted, prior, 0, true);
    const MatchResult free = std::exchange(result, held);
    if (isBetter(free, result, kStartGain, points, e)) result = free;
  }
  const auto tryFrom = [&](const Pose2& T_start, double start_gain, bool contradicted) {
    PosePrior elsewhere = prior;
    if (contradicted) {
      elsewhere.mean = T_start;
      elsewhere.information = scanmatch::poseInformation(3 * sigma_xy + 0.1, looseTurn(sigma_turn));
    }
    const auto other =
        keyframes::match(points, around_.maps(), T_start, elsewhere, options_->odometry_kernel, true);
    if (!isBetter(other, result, kStartGain, points, e)) return;
    result = other;
    is_dropped = contradicted;
    if (is_dropped) map_->note(core::JournalEvent::kDistrusted, start_gain);
  };
  if (start.gain > kStartGain) tryFrom(start.T_map_robot, start.gain, start.gain > options_->distrust_gain);
  // What the map around knows little of, the scan before may know well.
  if (e.has_odometry && (motion_.isFoundFromScans() || around_.isPoor(result, points)))
    if (const auto motion = motion_.fromScans(scan);
        motion && motion_.isSlip(*motion, e.step) && motion_.brokenBy(points, *motion) < kBrokenMotion)
      tryFrom(e.T_before * *motion, around_.gain(points, e.T_before * *motion, result.T_map_robot), true);
  if (around_.isPoor(result, points)) is_dropped = lookAround(points, e, result) || is_dropped;
  if (e.has_odometry) stayWithWheels(points, e, result);
  return {result, is_dropped};
}

/// A match that turns from odometry's heading may slide along what holds it least, until odometry's place
/// lets go; and two scans along a corridor do not tell how far the robot went. Where the found heading
/// explains as much at odometry's place, the robot is there.
void Tracker::stayWithWheels(const std::vector<PatchPoint>& points, const Expected& e,
                             MatchResult& result) const {
  const auto [T_step, sigma_xy, sigma_turn] = e.step;
  const Pose2& T = result.T_map_robot;
  if (core::distance(T, e.predicted) <= kLetGo * sigma_xy) return;
  // Along an arc the chord turns by half of what the heading does.
  const Pose2 by_half{e.T_before.x, e.T_before.y,
                      e.T_before.phi + core::angleDifference(T.phi, e.predicted.phi) / 2};
  PosePrior there;
  there.mean = by_half * T_step;
  there.mean.phi = T.phi;
  there.information = scanmatch::poseInformation(sigma_xy, looseTurn(sigma_turn));
  const MatchResult other = keyframes::match(points, around_.maps(), there.mean, there, 0, true);
  if (isBetter(other, result, -kStartGain, points, e)) result = other;
}

/// Whether the scan before says more for a match than odometry says against it, in a map that holds too few
/// keyframes to be asked later which of them was right: it could not grow meanwhile.
bool Tracker::isToldByScans(const Pose2& T, const std::vector<PatchPoint>& points, const Expected& e) const {
  if (static_cast<int>(around_.keyframes().size()) >= options_->loop_confirmations) return false;
  const double less_broken = motion_.brokenBy(points, e.step.T_previous_robot) -
                             motion_.brokenBy(points, core::between(e.T_before, T));
  return keyframes::kNatsPerScan * less_broken > unlikely(T, e);
}

std::optional<Unskewer::Unskewed> Tracker::unskew(const lidar::Scan& scan, const Points& points,
                                                  const Expected& e, const MatchResult& matched) {
  const lidar::Deskewing& by = scan.deskewing;
  if (!(by.sweep.duration_s > 0) || !(by.period_s > 0) || points.empty() || around_.isPoor(matched, points)) {
    unskewer_.forget();
    return std::nullopt;
  }
  // Scans are deskewed by odometry also where the method is told none.
  const bool is_untold = !e.has_odometry && by.is_measured;
  const Prediction told = is_untold ? motion_.predict(by.T_previous_robot, true) : e.step;
  return unskewer_.unskew(scan, points, around_.maps(), e.T_before, told, matched);
}

void Tracker::noteMatch(const Pose2& T, const std::vector<PatchPoint>& points, const Expected& e,
                        bool is_explained) {
  const auto isFarFrom = [&](const Pose2& from) {
    return core::distance(T, from) > kLetGo * e.step.sigma_xy_m ||
           std::abs(core::angleDifference(T.phi, from.phi)) > kLetGo * e.step.sigma_turn_rad;
  };
  const bool lets_go = e.has_odometry && isFarFrom(e.predicted) && !isToldByScans(T, points, e);
  followWheels(e.by_wheels, lets_go, isFarFrom(e.by_wheels), is_explained);
}

void Tracker::followWheels(const Pose2& T_wheels, bool lets_go, bool is_elsewhere, bool is_explained) {
  if (!by_wheels_ && !lets_go) return;
  if (!by_wheels_) unsure_from_ = map_->size(), explained_ = 0, let_go_m_ = map_->path_m();
  by_wheels_ = T_wheels;
  explained_ = is_explained ? explained_ + 1 : 0;
  // Beyond the map from before nothing will tell.
  const bool is_right =
      explained_ >= options_->loop_confirmations || map_->path_m() - let_go_m_ > options_->map_radius_m / 2;
  if (is_right)
    forgetWheels();
  else if (!is_elsewhere)
    by_wheels_.reset();
}

void Tracker::forgetWheels() {
  if (!by_wheels_) return;
  for (int k = unsure_from_; k < map_->size(); ++k) map_->keyframes()[static_cast<size_t>(k)].unsure = false;
  by_wheels_.reset();
}

}  // namespace slam::tracking
