#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/rigid_motion2.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::graph {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

/// Another start must explain this much more than odometry's to be taken at all.
constexpr double kStartGain = 0.02;
/// A start that explains so much of a scan is near enough; the two scans, which are dear, are not asked.
constexpr double kNearEnough = 0.9;
/// In standard deviations of odometry: a match farther from it has let it go.
constexpr double kLetGo = 3;
/// Where no odometry tells how far the robot went, it is looked for on a lattice of this pitch.
constexpr double kSlide_m = 0.2;
constexpr double kStartTurns_rad[] = {-0.15, -0.07, 0.07, 0.15};
/// Odometry's turn errs by so many of its standard deviations at most.
constexpr double kTurnedWrong = 4;
/// Two scans that contradict each other by more than this share after their own motion do not tell it.
constexpr double kBrokenMotion = 0.3;
/// And how far it turned, up to this, as stamps of real logs tell little of how fast.
constexpr double kTurnAbout_rad = 1, kTurnAboutStep_rad = 0.07;
/// Least share of the information along the worst direction of movement; below, a corridor or an open field.
constexpr double kDegenerate = 0.02;

/// In keyframes' distances: there the map's keyframes lie where there are many.
constexpr double kNear = 6;

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

/// Makes the map that the next scan is matched to of the first of these.
void GraphSlam::setMap(const std::vector<int>& near, const Point2& centre) {
  map_keyframes_ = keyframes::firstOf(near, options_.map_keyframes);
  map_->fill(maps_, map_keyframes_, centre);
}

/// Of the keyframes around the robot that are linked with the one that it hangs on.
void GraphSlam::setMapHere() {
  const Point2 centre = core::position(currentPose());
  // Where there are many, those of the map lie close, and to look farther costs much.
  auto near =
      map_->keyframesAround(anchor_, centre, options_.map_path_m, kNear * options_.keyframe_distance_m);
  if (static_cast<int>(near.size()) < options_.map_keyframes)
    near = map_->keyframesAround(anchor_, centre, options_.map_path_m, options_.map_radius_m);
  setMap(near, centre);
}

/// For a map that is finished.
void GraphSlam::setMapNear(const Point2& centre) {
  setMap(map_->keyframesWithin(centre, options_.map_radius_m), centre);
}

/// What is known of a scan's pose before it is matched.
keyframes::Expected GraphSlam::expect(const Pose2& T_previous_robot, bool has_odometry) const {
  keyframes::Expected e;
  e.step = predict(T_previous_robot, has_odometry);
  e.has_odometry = has_odometry;
  const Pose2& increment = e.step.T_previous_robot;
  e.T_before = currentPose();
  e.predicted = e.T_before * increment;
  // Some robots count backwards motion forwards, and turns as they are.
  e.backwards = e.T_before * Pose2{-increment.x, -increment.y, increment.phi};
  e.by_wheels = by_wheels_.value_or(e.T_before) * increment;
  return e;
}

/// The start that explains most of a scan, less what odometry holds against it; odometry's own unless it
/// explains more than that by kStartGain. Turned by a quarter a crossing looks much alike.
keyframes::Start GraphSlam::bestStart(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                                      const keyframes::Expected& e) const {
  const double own = surfelScore(points, maps_.coarse, e.predicted, keyframes::kKernel, keyframes::kStride);
  keyframes::Start best{e.predicted, kStartGain};
  double worth = -std::numeric_limits<double>::infinity();  // of the best start but odometry's own
  const auto consider = [&](const Pose2& candidate) {
    const double gain = surfelScore(points, maps_.coarse, candidate, keyframes::kKernel, keyframes::kStride,
                                    own + std::max(kStartGain, worth)) -
                        own;
    if (gain <= std::max(kStartGain, worth)) return;
    const double left = e.has_odometry ? gain - unlikely(candidate, e) / keyframes::kNatsPerScan : gain;
    if (left > worth) best = {candidate, gain}, worth = left;
  };
  consider(e.T_before * T_previous_robot_);
  consider(e.backwards);
  if (by_wheels_) consider(e.by_wheels);
  const auto turned = [&](double turn) {
    consider({e.predicted.x, e.predicted.y, e.predicted.phi + turn});
    if (by_wheels_) consider({e.by_wheels.x, e.by_wheels.y, e.by_wheels.phi + turn});
  };
  for (const double turn : kStartTurns_rad) turned(turn);
  if (e.has_odometry) {
    // As far as wheels err that turn with the robot.
    const double most = std::min(kTurnedWrong * sigmaOfWheels_rad(e.step.T_previous_robot), kTurnAbout_rad);
    for (double turn = kStartTurns_rad[3] + kTurnAboutStep_rad; turn <= most; turn += kTurnAboutStep_rad)
      turned(-turn), turned(turn);
  }
  if (!e.has_odometry) turnAbout(e, consider);
  const bool from_scans =
      !e.has_odometry || (best.gain > options_.distrust_gain && own + best.gain < kNearEnough);
  const auto motion = from_scans ? motionFromScans(scan) : std::nullopt;
  if (motion) consider(e.T_before * *motion);
  if (!e.has_odometry) slide(e, motion.value_or(core::between(e.T_before, best.T_map_robot)), consider);
  return best;
}

/// Every turn within reach where nothing tells it, on the spot and where the last motion leads.
void GraphSlam::turnAbout(const keyframes::Expected& e,
                          const std::function<void(const Pose2&)>& consider) const {
  const int steps = static_cast<int>(kTurnAbout_rad / kTurnAboutStep_rad);
  for (int turn = -steps; turn <= steps; ++turn) {
    const double phi = e.T_before.phi + kTurnAboutStep_rad * turn;
    consider({e.T_before.x, e.T_before.y, phi});
    consider({e.predicted.x, e.predicted.y, phi});
  }
}

/// Two scans along a corridor look like one: they do not tell how far the robot went, but the map may. Every
/// place within reach, with the headings that the last motion and the two scans have, or else the best start
/// so far.
void GraphSlam::slide(const keyframes::Expected& e, const Pose2& motion,
                      const std::function<void(const Pose2&)>& consider) const {
  const int steps = static_cast<int>(farthestMove() / kSlide_m);
  for (int x = -steps; x <= steps; ++x)
    for (int y = -steps; y <= steps; ++y)
      for (const double phi : {e.predicted.phi, e.T_before.phi + motion.phi})
        consider({e.T_before.x + kSlide_m * x, e.T_before.y + kSlide_m * y, phi});
}

/// What odometry holds against a pose, in nats.
double GraphSlam::unlikely(const Pose2& T, const keyframes::Expected& e) const {
  const auto by = [&](const Pose2& T_odometry) {
    return heldAgainst(T, T_odometry, e.step.sigma_xy_m, e.step.sigma_turn_rad);
  };
  const double held = std::min(by(e.predicted), way_sign_.against() + by(e.backwards));
  return by_wheels_ ? std::min(held, by(e.by_wheels)) : held;
}

/// How far the scan before contradicts a pose: from where that was matched, or where wheels have it.
double GraphSlam::brokenAt(const Pose2& T, const std::vector<PatchPoint>& points,
                           const keyframes::Expected& e) const {
  const double matched = brokenBy(points, core::between(e.T_before, T));
  return by_wheels_ ? std::min(matched, brokenBy(points, core::between(*by_wheels_, T))) : matched;
}

/// Whether scan, map and the scan before say more for a match than odometry says against it.
bool GraphSlam::isBetter(const MatchResult& other, const MatchResult& than, double least_gain,
                         const std::vector<PatchPoint>& points, const keyframes::Expected& e) const {
  const double against = unlikely(other.T_map_robot, e) - unlikely(than.T_map_robot, e);
  const double least = std::max(least_gain, against / keyframes::kNatsPerScan);
  const double gained = gain(points, other.T_map_robot, than.T_map_robot);
  const double less_broken = brokenAt(than.T_map_robot, points, e) - brokenAt(other.T_map_robot, points, e);
  if (other.score >= options_.recover_score) return gained + std::max(less_broken, 0.0) > least;
  // Wheels are worth more than an explanation of less than half.
  if (e.has_odometry && toldScore(points, other.T_map_robot) < options_.lost_score) return false;
  return gained + less_broken > least;
}

bool GraphSlam::isPoor(const MatchResult& result, const std::vector<PatchPoint>& points) const {
  return result.score < options_.recover_score &&
         toldScore(points, result.T_map_robot) < options_.recover_score;
}

/// The best match of a scan to the map around, and whether odometry was dropped for it.
std::pair<MatchResult, bool> GraphSlam::bestMatch(const lidar::Scan& scan,
                                                  const std::vector<PatchPoint>& points,
                                                  const keyframes::Expected& e) {
  const auto [T_step, sigma_xy, sigma_turn] = e.step;
  const keyframes::Start start = bestStart(scan, points, e);
  PosePrior prior;
  prior.mean = e.predicted;
  prior.information = scanmatch::poseInformation(sigma_xy, sigma_turn);
  MatchResult result = keyframes::match(points, maps_, e.predicted, prior, options_.odometry_kernel, true);
  bool distrusted = false;
  if (core::distance(result.T_map_robot, e.predicted) > kLetGo * sigma_xy) {
    // Odometry is let go for a better match only, not along a corridor that holds nothing.
    const auto held = keyframes::match(points, maps_, e.predicted, prior, 0, true);
    const MatchResult free = std::exchange(result, held);
    if (isBetter(free, result, kStartGain, points, e)) result = free;
  }
  const auto tryFrom = [&](const Pose2& T_start, double start_gain, bool contradicted) {
    PosePrior elsewhere = prior;
    if (contradicted) {
      elsewhere.mean = T_start;
      elsewhere.information = scanmatch::poseInformation(3 * sigma_xy + 0.1, looseTurn(sigma_turn));
    }
    const auto other = keyframes::match(points, maps_, T_start, elsewhere, options_.odometry_kernel, true);
    if (!isBetter(other, result, kStartGain, points, e)) return;
    result = other;
    distrusted = contradicted;
    if (distrusted) map_->note(core::JournalEvent::kDistrusted, start_gain);
  };
  if (start.gain > kStartGain) tryFrom(start.T_map_robot, start.gain, start.gain > options_.distrust_gain);
  // What the map around knows little of, the scan before may know well.
  if (e.has_odometry && (has_motion_ || isPoor(result, points)))
    if (const auto motion = motionFromScans(scan);
        motion && isSlip(*motion, e.step) && brokenBy(points, *motion) < kBrokenMotion)
      tryFrom(e.T_before * *motion, gain(points, e.T_before * *motion, result.T_map_robot), true);
  if (isPoor(result, points)) distrusted = lookAround(points, e, result) || distrusted;
  if (e.has_odometry) stayWithWheels(points, e, result);
  return {result, distrusted};
}

/// While a match turns far from odometry's heading it may slide along what holds it least, until odometry's
/// place lets go. Where the found heading explains as much there, the robot is there.
void GraphSlam::stayWithWheels(const std::vector<PatchPoint>& points, const keyframes::Expected& e,
                               MatchResult& result) const {
  const auto [T_step, sigma_xy, sigma_turn] = e.step;
  const Pose2& T = result.T_map_robot;
  if (core::distance(T, e.predicted) <= kLetGo * sigma_xy ||
      std::abs(core::angleDifference(T.phi, e.predicted.phi)) <= kLetGo * sigma_turn)
    return;
  PosePrior there;
  there.mean = {e.predicted.x, e.predicted.y, T.phi};
  there.information = scanmatch::poseInformation(sigma_xy, looseTurn(sigma_turn));
  const MatchResult other = keyframes::match(points, maps_, there.mean, there, 0, true);
  if (isBetter(other, result, -kStartGain, points, e)) result = other;
}

/// Matches a scan to the map around. Fills in its points and the information that they give, map axes.
GraphSlam::Step GraphSlam::track(const lidar::Scan& scan, const Pose2& T_previous_robot, bool has_odometry,
                                 std::vector<PatchPoint>& points, Eigen::Matrix3d& information) {
  points = keyframes::pointsOf(scan, options_);
  const keyframes::Expected e = expect(T_previous_robot, has_odometry);
  const auto [result, distrusted] = bestMatch(scan, points, e);
  const Pose2& T = result.T_map_robot;
  const bool is_poor = isPoor(result, points);
  if (is_poor) map_->note(core::JournalEvent::kPoor, result.score);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> movement(result.information.topLeftCorner<2, 2>(),
                                                                Eigen::EigenvaluesOnly);
  const double share = movement.eigenvalues()(1) > 0
                           ? std::max(movement.eigenvalues()(0), 0.0) / movement.eigenvalues()(1)
                           : 0;
  if (share < kDegenerate) map_->note(core::JournalEvent::kDegenerate, share);

  odometry_holds_ = odometry_holds_ && has_odometry && !distrusted;
  const auto isFarFrom = [&](const Pose2& from) {
    return core::distance(T, from) > kLetGo * e.step.sigma_xy_m ||
           std::abs(core::angleDifference(T.phi, from.phi)) > kLetGo * e.step.sigma_turn_rad;
  };
  const bool lets_go = has_odometry && isFarFrom(e.predicted) && !isToldByScans(T, points, e);
  followWheels(e.by_wheels, lets_go, isFarFrom(e.by_wheels), !is_poor);
  T_previous_robot_ = core::between(e.T_before, T);
  T_keyframe_robot_ = core::between(map_->pose(anchor_), T);
  T_odometry_ = T_odometry_ * e.step.T_previous_robot;
  map_->drive(core::hypot(T_previous_robot_.x, T_previous_robot_.y));
  Step step;
  step.T_map_robot = T;
  step.score = result.score;
  noteEvidence(points, T, maps_.fine);
  information = keyframes::toldInformation(evidence_);
  if (has_odometry && !is_poor && doubt_.begins < 0 && held_back_ == 0)
    learnWheels(e, T, information, result.posterior_information, !distrusted && !by_wheels_);
  else
    wheels_.endPiece();
  estimateCovariance(e, result);
  step.drift_covariance = driftSinceKeyframe();
  step.pose_covariance = covariance_;
  return step;
}

/// Whether the scan before says more for a match than odometry says against it, in a map that holds too few
/// keyframes to be asked later which of them was right: it could not grow meanwhile.
bool GraphSlam::isToldByScans(const Pose2& T, const std::vector<PatchPoint>& points,
                              const keyframes::Expected& e) const {
  if (static_cast<int>(map_keyframes_.size()) >= options_.loop_confirmations) return false;
  const double less_broken =
      brokenBy(points, e.step.T_previous_robot) - brokenBy(points, core::between(e.T_before, T));
  return keyframes::kNatsPerScan * less_broken > unlikely(T, e);
}

/// Where odometry alone has the robot since it was let go, for as long as it may have been right after all.
/// It was not when some scans in a row are explained; it was when the robot is there again, and then the
/// keyframes in between lie wrong. Meanwhile they do not vouch for themselves.
void GraphSlam::followWheels(const Pose2& T_wheels, bool let_go, bool is_elsewhere, bool is_explained) {
  if (!by_wheels_ && !let_go) return;
  if (!by_wheels_) unsure_from_ = map_->size(), explained_ = 0, let_go_m_ = map_->path_m();
  by_wheels_ = T_wheels;
  explained_ = is_explained ? explained_ + 1 : 0;
  // Beyond the map from before nothing will tell.
  const bool is_right =
      explained_ >= options_.loop_confirmations || map_->path_m() - let_go_m_ > options_.map_radius_m / 2;
  if (is_right)
    forgetWheels();
  else if (!is_elsewhere)
    by_wheels_.reset();
}

/// What was matched since odometry was let go is believed.
void GraphSlam::forgetWheels() {
  if (!by_wheels_) return;
  for (int k = unsure_from_; k < map_->size(); ++k) map_->keyframes()[static_cast<size_t>(k)].unsure = false;
  by_wheels_.reset();
}

/// How far the robot went and turned beside what odometry says; of a step that is not believed, only whether
/// it went the other way.
void GraphSlam::learnWheels(const keyframes::Expected& e, const Pose2& T, const Eigen::Matrix3d& information,
                            const Eigen::Matrix3d& posterior_information, bool is_believed) {
  const Pose2& step = e.step.T_previous_robot;
  const auto told = scanmatch::toldShares(information, posterior_information, step, e.T_before.phi);
  const Pose2 matched = core::between(e.T_before, T);
  way_sign_.learn(step, matched, told.way);
  if (is_believed)
    wheels_.learn(step, matched, told.way, told.turn);
  else
    wheels_.endPiece();
}

/// Puts odometry's word in place of a match.
void GraphSlam::keepTo(const Pose2& predicted, const Pose2& increment, Step& step) {
  step.T_map_robot = predicted;
  const Eigen::Matrix3d drift = held_back_ * scanmatch::covarianceOf(scanmatch::poseInformation(
                                                 options_.odometry_xy_m, options_.odometry_turn_rad));
  step.drift_covariance += drift;
  step.pose_covariance += drift;
  T_previous_robot_ = increment;
  wheels_.endPiece();
  T_keyframe_robot_ = core::between(map_->pose(anchor_), predicted);
}

/// Share of a scan's points that fall on a mapped surface, or near one.
double GraphSlam::knownShare(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  const Point2 origin = maps_.coarse.origin();
  const core::RigidMotion2 T_map_points(T_map_robot);
  int known = 0;
  for (const auto& point : points) {
    const Point2 p_map = T_map_points * position(point);
    known += maps_.coarse.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  }
  return points.empty() ? 0 : static_cast<double>(known) / static_cast<double>(points.size());
}

}  // namespace slam::graph
