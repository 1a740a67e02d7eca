#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/uncertainty/pose_error.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"

namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// An edge of odometry that was not to be trusted.
constexpr double kDistrustedFactor = 5;

}  // namespace

GraphSlam::GraphSlam(const keyframes::GraphOptions& options)
    : options_(options),
      map_(std::make_unique<keyframes::KeyframeMap>(options)),
      loops_(*map_),
      finder_(*map_),
      tracker_(*map_),
      uncertainty_(*map_),
      known_ground_(*map_) {}

void GraphSlam::useThreads(int threads) {
  using Where = loops::LoopCloser::Where;
  loops_.workBy(threads > 1 ? Where::kByThread : Where::kHere);
}

Pose2 GraphSlam::currentPose() const {
  return map_->pose(anchor_) * T_keyframe_robot_;
}

GraphSlam::Step GraphSlam::process(const lidar::Scan& given, const Pose2& T_previous_robot,
                                   bool has_odometry) {
  lidar::Scan scan = given;
  if (scan.ranges_m.size() < 2) throw core::ContractError("GraphSlam: a scan of fewer than 2 beams");
  has_odometry = motion().begin(scan, T_previous_robot, has_odometry);
  // What a doubt holds of the map would not move with it.
  if (loops_.continueClosing(doubt_.begins < 0 && held_back_ == 0)) haveMoved();
  Step step;
  if (map_->keyframes().empty()) {
    addKeyframe(scan, keyframes::pointsOf(scan, options_), {}, Eigen::Matrix3d::Zero());
    step.is_keyframe = true;
  } else {
    std::vector<PatchPoint> points;
    Eigen::Matrix3d information;
    const Pose2 increment = has_odometry ? motion().corrected(T_previous_robot) : motion().step();
    const Pose2 T_before = currentPose();
    if (has_odometry) T_wheels_ = T_wheels_ * T_previous_robot;
    step = track(scan, increment, has_odometry, points, information);
    const Pose2 matched = core::between(T_before, step.T_map_robot);
    const keyframes::Break seam = breakBefore(scan, points, T_before, increment, matched, has_odometry);
    lookWhetherLost(scan, points, step, has_odometry ? increment : matched, seam.contradicted, has_odometry);
    const keyframes::Trust trust = weighDoubt(T_before, seam, points.size(), step);
    if (trust == keyframes::Trust::kWell && step.score >= options_.recover_score) ++explained_here_;
    step.is_keyframe = trust == keyframes::Trust::kOwnMap ||
                       (trust == keyframes::Trust::kWell && needsKeyframe(scan, points, step));
    if (trust == keyframes::Trust::kBack) {
      comeBack(scan, points, step);
      step.is_keyframe = true;
    } else if (step.is_keyframe) {
      if (doubt_.begins < 0) learnWrongPlace(scan, points, step.T_map_robot);
      if (trust == keyframes::Trust::kOwnMap) beginOwnMap();
      if (trust == keyframes::Trust::kWell) map_->noteExplained(step.score);
      addKeyframe(scan, std::move(points), step.T_map_robot, information);
      if (trust == keyframes::Trust::kWell && is_known_ground_)
        known_ground_.retireOldest(map_->lastKeyframe());
      step.pose_covariance = uncertainty_.covariance();
    }
    if (lost_.isLost() && doubt_.begins >= 0) startElsewhere(step.score);
    step.T_map_robot = currentPose();
  }
  if (options_.loops && map_->isCutOff(map_->lastKeyframe()) && doubt_.begins < 0 && !loops_.isClosing())
    lookForPart(map_->parts().back().begin, map_->lastKeyframe());
  if (const auto accepted = loops_.continueSearching()) {
    noteLoop(*accepted);
    setMapHere();
    step.T_map_robot = currentPose();
  }
  records_.push_back({anchor_, T_keyframe_robot_, step.drift_covariance});
  map_->nextScan();
  motion().end(scan);
  return step;
}

void GraphSlam::startAt(const Pose2& T_map_robot) {
  if (map_->keyframes().empty()) throw core::ContractError("GraphSlam: startAt() without a map");
  completeClosing();
  T_keyframe_robot_ = core::between(map_->pose(anchor_), T_map_robot);
  motion().restart();
  odometry_holds_ = false;
  uncertainty_.restart();
  tracker_.forgetWheels();
  lost_.restart();
  doubt_ = {};
  explained_here_ = 1;  // what was given is a map
  is_lost_ = false;
  finder_.endTrail();
  around().fillNear(core::position(T_map_robot));
}

/// What the scans cannot see, odometry has to hold; where it was wrong, the matched motion stands in for it,
/// weakly.
int GraphSlam::addOdometryEdge(int k) {
  posegraph::Edge edge;
  edge.from = anchor_, edge.to = k;
  edge.T_from_to = odometry_holds_ ? T_odometry_ : core::between(map_->pose(anchor_), map_->pose(k));
  // Across a break nothing tells whether wheels slipped or the robot was carried.
  const double factor = odometry_holds_ && doubt_.begins != k ? 1 : kDistrustedFactor;
  const double move_m = core::hypot(edge.T_from_to.x, edge.T_from_to.y),
               turn_rad = std::abs(edge.T_from_to.phi);
  edge.information = scanmatch::poseInformation(
      factor * (options_.odometry_xy_m + options_.odometry_xy_per_m * move_m),
      factor * (options_.odometry_turn_rad + options_.odometry_turn_per_rad * turn_rad));
  const int added = map_->graph().addEdge(edge);
  if (odometry_holds_) by_wheels_.push_back({added, T_keyframe_hung_, T_wheels_});
  return added;
}

/// By all that the drive has shown of the wheels: what was driven before anything was learnt of them, too.
void GraphSlam::setOdometryRight() {
  for (const auto& [edge, T_keyframe_hung, T_wheels] : by_wheels_)
    map_->graph().setMeasurement(edge, T_keyframe_hung * motion().corrected(T_wheels));
}

void GraphSlam::addKeyframe(const lidar::Scan& scan, std::vector<PatchPoint> points, const Pose2& T_map_robot,
                            const Eigen::Matrix3d& information) {
  const int k = map_->graph().addNode(T_map_robot);
  const core::Point2 view_centre = keyframes::centreOf(points);
  map_->keyframes().push_back({map_->scan(),
                               scan,
                               std::move(points),
                               view_centre,
                               map_->path_m(),
                               -1,
                               tracker_.isFollowingWheels(),
                               false,
                               uncertainty_.noise(),
                               {},
                               uncertainty_.inheritance()});
  map_->links().addKeyframe();
  if (k == 0) {
    map_->graph().setFixed(0);
  } else {
    map_->keyframes().back().odometry_edge = addOdometryEdge(k);
    uncertainty_.inherit(k);
    if (doubt_.begins != k && map_->parts().back().begin != k) map_->link(anchor_, k);
    // What was driven on known ground is no way from one to the other.
    if (anchor_ != k - 1) map_->addClosure(anchor_, k);
    addMatchEdges(k, T_map_robot, information);
  }
  map_->setErrors(k, uncertainty_.errors());
  anchor_ = k;
  uncertainty_.beginKeyframe(k);
  T_keyframe_robot_ = T_keyframe_hung_ = T_odometry_ = T_wheels_ = {};
  odometry_holds_ = true;
  if (options_.loops && k > 0)
    if (const auto accepted = loops_.closeLoops()) noteLoop(*accepted);
  setMapHere();
}

std::vector<Pose2> GraphSlam::poses() const {
  std::vector<Pose2> result;
  result.reserve(records_.size());
  for (const auto& record : records_) result.push_back(map_->pose(record.keyframe) * record.T_keyframe_robot);
  return result;
}

void GraphSlam::finish(core::Progress& progress) {
  if (map_->keyframes().empty()) return;
  completeClosing();
  settleDoubt();
  if (options_.loops) joinRemainingParts();
  const auto first_new =
      std::find_if(map_->keyframes().begin(), map_->keyframes().end(),
                   [](const keyframes::Keyframe& one) { return one.scan != keyframes::kOfEarlierRun; });
  if (options_.loops)
    loops_.searchRemainingLoops(
        static_cast<int>(first_new - map_->keyframes().begin()), [this] { haveMoved(); }, progress);
  // What was known before stays as it is when nothing came to it.
  const bool has_come = first_new != map_->keyframes().end();
  setOdometryRight();
  if (has_come && loops_.closeRest()) haveMoved();
  noteWhatStaysApart();
  if (has_come && options_.refine_rounds > 0) refine(progress);
  motion().noteWheels();
}

}  // namespace slam::graph
