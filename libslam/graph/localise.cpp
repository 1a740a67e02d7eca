#include <cmath>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// Where less of a scan than this falls on what is mapped, the robot has left the map.
constexpr double kLeastKnown = 0.5;
/// A scan fits where it lies, within this.
constexpr double kSame_m = 0.5, kSame_rad = 0.2;

}  // namespace

void GraphSlam::startAnywhere() {
  if (map_->keyframes().empty()) throw core::ContractError("GraphSlam: startAnywhere() without a map");
  startAt(map_->pose(0));
  beLost(0);
}

/// Poses are told in the map as it is, whatever that errs by.
void GraphSlam::beginLocalising() {
  if (std::exchange(is_localising_, true)) return;
  for (int k = 0; k < map_->size(); ++k) map_->setErrors(k, {});
}

GraphSlam::Step GraphSlam::localise(const lidar::Scan& given, const Pose2& T_previous_robot,
                                    bool has_odometry) {
  if (map_->keyframes().empty()) throw core::ContractError("GraphSlam: localise() without a map");
  completeClosing();
  beginLocalising();
  lidar::Scan scan = given;
  std::vector<PatchPoint> points;
  Eigen::Matrix3d information;
  has_odometry = motion().begin(scan, T_previous_robot, has_odometry);
  Pose2 increment = has_odometry ? motion().corrected(T_previous_robot) : motion().step();
  if (is_lost_ && !has_odometry) increment = motion().fromScans(scan).value_or(increment);
  const Pose2 predicted = currentPose() * increment;
  Step step;
  if (is_lost_) {
    points = keyframes::pointsOf(scan, options_);
    step.score = 0;
    step.T_map_robot = predicted;
    ++held_back_;
    keepTo(predicted, increment, step);
    if (searchWhileLost(points, step)) {
      is_lost_ = false;
      held_back_ = 0;
      lost_.restart();
      finder_.endTrail();
      map_->note(core::JournalEvent::kRecovered, step.score);
    }
  } else {
    const Pose2 T_before = currentPose();
    step = track(scan, increment, has_odometry, points, information);
    const keyframes::Break seam = breakBefore(scan, points, T_before, increment,
                                              core::between(T_before, step.T_map_robot), has_odometry);
    lookWhetherLost(scan, points, step, increment, seam.contradicted, has_odometry);
    // A robot that has left the map is not searched for: odometry leads it back. What little fits would
    // mislead it; and it is back when a scan fits as a whole.
    const bool was_outside = is_outside_;
    is_outside_ = around().knownShare(points, predicted) < kLeastKnown ||
                  (was_outside && !fitsMap(points, step.T_map_robot));
    if (is_outside_ != was_outside)
      map_->note(is_outside_ ? core::JournalEvent::kOutside : core::JournalEvent::kInside, step.score);
    if (is_outside_ || lost_.isInDoubt()) {
      ++held_back_;
      keepTo(predicted, increment, step);
    } else {
      held_back_ = 0;
    }
    if (lost_.isLost()) beLost(step.score);
  }
  odometry_holds_ = false;
  T_keyframe_robot_ = core::between(map_->pose(anchor_), step.T_map_robot);
  if (!is_lost_) around().fillNear(core::position(step.T_map_robot));
  records_.push_back({anchor_, T_keyframe_robot_, step.drift_covariance});
  map_->nextScan();
  motion().end(scan);
  return step;
}

/// While nobody knows where the robot is: by its wheels, and by what it has seen since, all over the map.
bool GraphSlam::searchWhileLost(const std::vector<PatchPoint>& points, Step& step) {
  const auto found = finder_.lookForRobot(currentPose(), points);
  if (!found) return false;
  step.T_map_robot = found->T_map_robot;
  step.score = found->score;
  return true;
}

/// Whether a scan as a whole fits the map near a pose: explained, and seen through by no beam.
bool GraphSlam::fitsMap(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  const auto around = keyframes::firstOf(
      map_->keyframesWithin(core::position(T_map_robot), options_.map_radius_m), options_.map_keyframes);
  if (around.empty()) return false;
  const auto matched = map_->matchFreely(points, around, T_map_robot);
  return matched.score >= options_.recover_score &&
         core::distance(matched.T_map_robot, T_map_robot) < kSame_m &&
         std::abs(core::angleDifference(matched.T_map_robot.phi, T_map_robot.phi)) < kSame_rad &&
         map_->meanConflict(keyframes::firstOf(around, keyframes::kViewers), matched.T_map_robot, points) <
             options_.loop_conflict;
}

void GraphSlam::beLost(double score) {
  map_->note(core::JournalEvent::kLost, score);
  is_lost_ = true, is_outside_ = false;
  lost_.restart();
  finder_.beginTrail();
}

}  // namespace slam::graph
