#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

/// A doubt that passes within this time, and within a keyframe's distance, leaves nothing in the map: a
/// glitch, somebody who stands before the lidar.
constexpr double kHold_s = 0.5;
/// A scan of which less is known than this share says nothing.
constexpr double kTold = 0.1;
/// Standard deviations of where a kidnapped robot was put down: anywhere.
constexpr double kGap_m = 30, kGap_rad = 3;
/// Keyframes that are all learnt from; then one in so many.
constexpr int kLearntSoon = 20;
/// In standard deviations of odometry.
constexpr double kMissed = 4;
/// Wheels slipped, other than a robot that was carried off, when another motion leaves less than this share
/// of the contradiction between two scans.
constexpr double kSlipped = 0.5;
/// Two scans that contradict each other more than this are matched to each other.
constexpr double kAskScans = 0.1;
constexpr int kAsked = keyframes::kAskedViewers;
constexpr double kGoldenAngle_rad = 2.399963;
/// A wrong place that is matched nearer to the right heading is none.
constexpr double kFoundBack_rad = 0.3;

}  // namespace

/// The motion since the scan before by which the two scans contradict each other least, and by how much: as
/// odometry has it, as matched, or, where these do not fit, as the two scans alone have it.
keyframes::Break GraphSlam::breakBefore(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                                        const Pose2& T_before, const Pose2& T_previous_robot,
                                        const Pose2& T_previous_matched, bool has_odometry) const {
  if (motion().before() == nullptr || points.empty()) return {T_previous_robot, std::nan("")};
  keyframes::Break best{T_previous_robot, 1};
  const auto consider = [&](const Pose2& T) {
    const double conflict = motion().brokenBy(points, T);
    if (conflict < best.contradicted) best = {T, conflict};
  };
  // What wheels cannot have missed is a break, unless scan, map and the scan before all agree on a slip.
  const tracking::Prediction odometry = motion().predict(T_previous_robot, has_odometry);
  const Pose2 T_backwards{-T_previous_robot.x, -T_previous_robot.y, T_previous_robot.phi};
  const auto isNear = [&](const Pose2& T, const Pose2& T_odometry) {
    return core::distance(T, T_odometry) < kMissed * odometry.sigma_xy_m &&
           std::abs(core::angleDifference(T.phi, T_odometry.phi)) < kMissed * odometry.sigma_turn_rad;
  };
  consider(T_previous_robot);
  const double by_odometry = best.contradicted;
  if (by_odometry <= 0) return best;  // nothing contradicts less
  const auto isPossible = [&](const Pose2& T) {
    if (isNear(T, T_previous_robot) || isNear(T, T_backwards)) return true;
    return by_odometry > tracking::kBroken && motion().isSlip(T, odometry) &&
           motion().brokenBy(points, T) < kSlipped * by_odometry &&
           around().toldScore(points, T_before * T) >= options_.recover_score;
  };
  if (isPossible(T_previous_matched)) consider(T_previous_matched);
  if (best.contradicted > kAskScans)
    if (const auto found = motion().fromScans(scan); found && isPossible(*found)) consider(*found);
  return best;
}

/// What a scan says of whether the robot was kidnapped. A scan that the map explains does not contradict it,
/// whatever beams went through where somebody stands now.
void GraphSlam::lookWhetherLost(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                                const Step& step, const Pose2& increment, double broken, bool has_odometry) {
  keyframes::Told told;
  double explained = step.score;
  if (doubt_.begins < 0) {
    told = map_->toldBy(map_->viewersOf(scan, step.T_map_robot, around().keyframes(), kAsked), points,
                        step.T_map_robot, &scan);
  } else {
    told = trackBefore(scan, points, increment, has_odometry, explained);
    // People who walk about contradict what was seen a moment ago, too.
    const auto own = map_->toldBy(map_->viewersOf(scan, step.T_map_robot, around().keyframes(), kAsked),
                                  points, step.T_map_robot, &scan);
    told.contradicted = std::max(told.contradicted - own.contradicted, 0.0);
  }
  LostDetector::Look look{};
  look.time_s = scan.time_s;
  look.moved_m = core::hypot(increment.x, increment.y);
  look.broken = broken;
  look.contradicted = told.against(explained);
  look.telling = std::min(told.contradicted * told.telling + explained, 1.0);
  look.may_be_lost = explained < options_.lost_score && !(doubt_.begins >= 0 && loops_.isWhereExpected());
  lost_.look(look);
  if (look.telling < kTold) doubt_.untold_m += look.moved_m;
}

/// While in doubt: where the robot is if it was not kidnapped, by the map from before, and what that says of
/// the scan. Odometry leads, within its noise.
keyframes::Told GraphSlam::trackBefore(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                                       const Pose2& increment, bool has_odometry, double& explained) {
  const tracking::Prediction step = motion().predict(increment, has_odometry);
  PosePrior prior;
  prior.mean = doubt_.T_map_robot * increment;
  prior.information = scanmatch::poseInformation(step.sigma_xy_m, step.sigma_turn_rad);
  const auto matched = keyframes::match(points, *doubt_.maps, prior.mean, prior, 0, true);
  const auto toldAt = [&](const Pose2& T) {
    return map_->toldBy(map_->viewersOf(scan, T, keyframesBeforeDoubt(T), kAsked), points, T, &scan);
  };
  const auto as_matched = toldAt(matched.T_map_robot), as_led = toldAt(prior.mean);
  const bool fits = as_matched.contradicted <= as_led.contradicted;
  doubt_.T_map_robot = fits ? matched.T_map_robot : prior.mean;
  doubt_.information = fits ? matched.information : prior.information;
  explained = matched.score;
  return fits ? as_matched : as_led;
}

/// What a scan contradicts where the robot is not: turned on the spot, and matched again as a kidnapped robot
/// would be.
void GraphSlam::learnWrongPlace(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                                const Pose2& T_map_robot) {
  // Often in the beginning, seldom when much is known.
  ++wrong_places_;
  if (wrong_places_ > kLearntSoon && wrong_places_ % kLearntSoon != 0) return;
  if (around().keyframes().empty() || points.empty()) return;
  const double turn = 0.5 + std::fmod(wrong_places_ * kGoldenAngle_rad, 2 * core::kPi - 1);
  const Pose2 wrong{T_map_robot.x, T_map_robot.y, T_map_robot.phi + turn};
  scanmatch::PosePrior flat;
  flat.mean = wrong;
  flat.information.setIdentity();
  const auto matched = keyframes::match(points, around().maps(), wrong, flat, 0, true);
  if (std::abs(core::angleDifference(matched.T_map_robot.phi, T_map_robot.phi)) < kFoundBack_rad) return;
  const auto viewers = map_->viewersOf(scan, matched.T_map_robot, around().keyframes(), kAsked);
  if (viewers.empty()) return;
  lost_.learnWrong(map_->toldBy(viewers, points, matched.T_map_robot, &scan).against(matched.score));
}

/// The keyframes from before the doubt, the nearest first.
std::vector<int> GraphSlam::keyframesBeforeDoubt(const Pose2& T_map_robot) const {
  std::vector<int> before;
  for (const int k : map_->keyframesWithin(core::position(T_map_robot), options_.map_radius_m)) {
    if (k < doubt_.begins && map_->componentOf(k) == map_->componentOf(doubt_.begins)) before.push_back(k);
  }
  return before;
}

/// Whether there was a map before the doubt: one that had explained a scan, and holds more points than these.
/// Of a yard in which the lidar reaches nothing, or one post, a map holds too little for a robot to be lost
/// from it; and what a first scan saw is no map when none after it fits.
bool GraphSlam::isKnownBefore(std::size_t points) const {
  if (doubt_.explained_before == 0) return false;
  std::size_t known = 0;
  for (int k = doubt_.begins - 1; k >= 0 && known <= points; --k)
    if (map_->componentOf(k) == map_->componentOf(doubt_.begins)) known += map_->keyframe(k).points.size();
  return known > points;
}

/// Whether a scan is believed. In doubt the robot first waits, moved as the two scans and odometry have it;
/// then it maps on by itself, in a map of its own, which stays part of the rest when the doubt passes.
keyframes::Trust GraphSlam::weighDoubt(const Pose2& T_before, const keyframes::Break& seam,
                                       std::size_t points, Step& step) {
  doubt_.explained = step.score;
  if (doubt_.begins >= 0) {
    if (!lost_.isInDoubt()) return keyframes::Trust::kBack;
    // The robot has left what was known before, or never knew as much as it sees now: nothing will prove it
    // any more.
    const bool is_known = isKnownBefore(points), is_left = doubt_.untold_m > options_.map_radius_m;
    if (is_left && is_known) lost_.decide();
    if ((is_left && !lost_.isLost()) || !is_known) endDoubt();
    return keyframes::Trust::kWell;
  }
  if (!lost_.isInDoubt()) {
    if (held_back_ > 0) lost_.dismiss();
    held_back_ = 0, doubt_ = {};
    return keyframes::Trust::kWell;
  }
  ++held_back_;
  doubt_.held_s += motion().period_s();
  keepTo(T_before * seam.T_previous_robot, seam.T_previous_robot, step);
  doubt_.held_m += core::hypot(seam.T_previous_robot.x, seam.T_previous_robot.y);
  const bool waits =
      doubt_.held_s < kHold_s && doubt_.held_m < options_.keyframe_distance_m && !lost_.isLost();
  return waits ? keyframes::Trust::kHeldBack : keyframes::Trust::kOwnMap;
}

/// The next keyframe begins a map of its own, for as long as the doubt lasts.
void GraphSlam::beginOwnMap() {
  tracker_.forgetWheels();
  doubt_.begins = map_->size();
  doubt_.explained_before = std::exchange(explained_here_, 0);
  doubt_.maps = std::make_shared<keyframes::LevelMaps>(around().maps());
  doubt_.T_map_robot = currentPose();
  around().setKeyframes({});
  uncertainty_.forgetViews();  // of the place where the robot is not
}

/// All is well again, and the robot is where the map from before has it. That map goes on from here; what was
/// mapped meanwhile hangs on it by odometry alone, and no scan is matched to it any more.
void GraphSlam::comeBack(const lidar::Scan& scan, std::vector<PatchPoint> points, Step& step) {
  const Pose2 T_map_robot = doubt_.T_map_robot;
  const Eigen::Matrix3d information = doubt_.information;
  const int before = map_->keyframeBefore(doubt_.begins), k = map_->size();
  tracker_.forgetWheels();
  explained_here_ = doubt_.explained_before;
  around().setKeyframes(keyframes::firstOf(keyframesBeforeDoubt(T_map_robot), kAsked));
  T_keyframe_robot_ = core::between(map_->pose(anchor_), T_map_robot);
  uncertainty_.noteEvidence(points, T_map_robot, doubt_.maps->fine);
  doubt_.begins = k;  // no link to the keyframe before
  addKeyframe(scan, std::move(points), T_map_robot, information);
  map_->link(before, k);
  lost_.dismiss();
  doubt_ = {};
  held_back_ = 0;
  setMapHere();
  step.pose_covariance = uncertainty_.covariance();
}

/// The doubt ends without an answer: what was mapped meanwhile is a part of the rest.
void GraphSlam::endDoubt() {
  map_->link(map_->keyframeBefore(doubt_.begins), doubt_.begins);
  explained_here_ += doubt_.explained_before;
  lost_.dismiss();
  doubt_ = {};
  held_back_ = 0;
}

/// Nothing comes any more that could end the doubt: what was told so far decides.
void GraphSlam::settleDoubt() {
  if (doubt_.begins < 0) return;
  if (isKnownBefore(map_->keyframe(map_->lastKeyframe()).points.size())) lost_.decide();
  if (lost_.isLost())
    startElsewhere(doubt_.explained);
  else
    endDoubt();
}

/// What was mapped since the doubt began is a part of the map whose place in the rest is not known.
void GraphSlam::startElsewhere(double score) {
  completeClosing();
  map_->note(core::JournalEvent::kLost, score);
  const int k = doubt_.begins;
  loosen(k);
  for (int i = k; i < map_->size(); ++i) {
    map_->keyframes()[static_cast<size_t>(i)].path_m += keyframes::kGapPath_m;
    map_->setErrors(i, uncertainty_.errors());
  }
  map_->drive(keyframes::kGapPath_m);
  moveHeldBackTo(k);
  beginPart(k);
  loops_.forget();
  lost_.restart();
  doubt_ = {};
  held_back_ = 0;
}

/// Nothing is known of how keyframe k lies to the one before.
void GraphSlam::loosen(int k) {
  posegraph::Edge gap = map_->graph().edges()[static_cast<size_t>(map_->keyframe(k).odometry_edge)];
  map_->graph().setOn(map_->keyframe(k).odometry_edge, false);
  map_->removeClosure(gap.from, k);
  gap.information = scanmatch::poseInformation(kGap_m, kGap_rad);
  map_->keyframes()[static_cast<size_t>(k)].odometry_edge = map_->graph().addEdge(gap);
  map_->keyframes()[static_cast<size_t>(k)].inherited = {};
  uncertainty_.setCovariance(scanmatch::covarianceOf(gap.information));
}

/// The scans that were held back when the doubt began belong to the new part.
void GraphSlam::moveHeldBackTo(int k) {
  const Pose2& T_map_keyframe = map_->pose(k);
  const int first = map_->keyframe(k).scan;
  for (int i = std::max(first - held_back_ + 1, 0); i < first; ++i) {
    auto& record = records_[static_cast<size_t>(i)];
    const Pose2 T_map_robot = map_->pose(record.keyframe) * record.T_keyframe_robot;
    record = {k, core::between(T_map_keyframe, T_map_robot), record.drift_covariance};
  }
}

}  // namespace slam::graph
