#include "libslam/graph/graph_slam.h"
#include "libslam/graph/matching.h"
#include "libslam/graph/search.h"

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
constexpr int kPartnerStep = 3;
/// A pass that says something of less of a scan holds it too weakly to measure how the passes lie.
constexpr double kLeastTelling = 0.2;

}  // namespace

GraphSlam::GraphSlam(const GraphOptions& options)
    : options_(options),
      map_(std::make_unique<KeyframeMap>(options)),
      loops_(*map_),
      finder_(*map_),
      maps_(options, true),
      pass_map_(options.cell_m, options.blur_m, true) {}

Pose2 GraphSlam::currentPose() const {
  return map_->pose(anchor_) * T_keyframe_robot_;
}

GraphSlam::Step GraphSlam::process(const robot::Scan& scan, const Pose2& T_previous_robot,
                                   bool has_odometry) {
  if (scan.ranges_m.size() < 2) throw core::ContractError("GraphSlam: a scan of fewer than 2 beams");
  noteScan(scan, has_odometry);
  // What a doubt holds of the map would not move with it.
  if (loops_.continueClosing(doubt_.begins < 0 && held_back_ == 0)) haveMoved();
  Step step;
  if (map_->keyframes().empty()) {
    addKeyframe(scan, pointsOf(scan, options_), {}, Eigen::Matrix3d::Zero());
    step.is_keyframe = true;
  } else {
    std::vector<PatchPoint> points;
    Eigen::Matrix3d information;
    const Pose2 increment = has_odometry ? T_previous_robot : T_previous_robot_;
    const Pose2 T_before = currentPose();
    step = track(scan, T_previous_robot, has_odometry, points, information);
    const Pose2 matched = core::between(T_before, step.T_map_robot);
    const Break seam = breakBefore(scan, points, increment, matched, has_odometry);
    lookWhetherLost(scan, points, step, has_odometry ? increment : matched, seam.contradicted);
    const Trust trust = weighDoubt(T_before, seam, step);
    step.is_keyframe =
        trust == Trust::kOwnMap || (trust == Trust::kWell && needsKeyframe(scan, points, step));
    if (trust == Trust::kBack) {
      comeBack(scan, points, step);
      step.is_keyframe = true;
    } else if (step.is_keyframe) {
      if (doubt_.begins < 0) learnWrongPlace(scan, points, step.T_map_robot);
      if (trust == Trust::kOwnMap) beginOwnMap();
      addKeyframe(scan, std::move(points), step.T_map_robot, information);
      if (trust == Trust::kWell && is_known_ground_) retireOldest(map_->lastKeyframe());
      step.pose_covariance = covariance_;
    }
    if (lost_.isLost() && doubt_.begins >= 0) startElsewhere(step.score);
    step.T_map_robot = currentPose();
  }
  if (options_.loops && map_->isCutOff(map_->lastKeyframe()) && doubt_.begins < 0 && !loops_.isClosing())
    lookForPart(map_->parts().back().begin, map_->lastKeyframe());
  records_.push_back({anchor_, T_keyframe_robot_, step.drift_covariance});
  map_->nextScan();
  keepScan(scan);
  return step;
}

void GraphSlam::startAt(const Pose2& T_map_robot) {
  if (map_->keyframes().empty()) throw core::ContractError("GraphSlam: startAt() without a map");
  completeClosing();
  T_keyframe_robot_ = core::between(map_->pose(anchor_), T_map_robot);
  T_previous_robot_ = {};
  odometry_holds_ = false;
  covariance_.setZero(), from_keyframe_.setZero();
  forgetWheels();
  lost_.restart();
  doubt_ = {};
  is_lost_ = false;
  finder_.endTrail();
  setMapNear(core::position(T_map_robot));
}

/// Two partners of a keyframe are so many keyframes apart: neighbours would say the same twice.
bool GraphSlam::isApart(int keyframe, const std::vector<int>& others) {
  return std::none_of(others.begin(), others.end(),
                      [&](int other) { return std::abs(other - keyframe) < kPartnerStep; });
}

/// The keyframes that a match is shared among: the nearest, not two in a row, and only those whose beams
/// agree.
std::vector<int> GraphSlam::partnersOf(int k, const std::vector<int>& near, const Pose2& T_map_robot) const {
  std::vector<int> partners;
  const auto& points = map_->keyframe(k).points;
  for (const int other : near) {
    if (other == k) continue;
    if (!isApart(other, partners)) continue;
    if (other != map_->keyframeBefore(k)) {
      const View seen = map_->view(other, core::between(map_->pose(other), T_map_robot), points);
      if (seen.conflict() > options_.link_conflict ||
          seen.agreed < options_.link_agreed * static_cast<double>(points.size()))
        continue;
    }
    partners.push_back(other);
    if (static_cast<int>(partners.size()) == options_.edges_per_keyframe) break;
  }
  return partners;
}

/// What the scans cannot see, odometry has to hold; where it was wrong, the matched motion stands in for it,
/// weakly.
int GraphSlam::addOdometryEdge(int k) {
  posegraph::Edge edge;
  edge.from = anchor_, edge.to = k;
  edge.T_from_to = odometry_holds_ ? T_odometry_ : core::between(map_->pose(anchor_), map_->pose(k));
  const double factor = odometry_holds_ ? 1 : kDistrustedFactor;
  const double move_m = core::hypot(edge.T_from_to.x, edge.T_from_to.y),
               turn_rad = std::abs(edge.T_from_to.phi);
  edge.information = scanmatch::poseInformation(
      factor * (options_.odometry_xy_m + options_.odometry_xy_per_m * move_m),
      factor * (options_.odometry_turn_rad + options_.odometry_turn_per_rad * turn_rad));
  return map_->graph().addEdge(edge);
}

/// Ties keyframe k to those that it was matched to. Those of an earlier pass may not lie as these do: each
/// pass gets the pose that a match to it alone gives, so that an edge says what was measured between its
/// ends, and not where their mean was.
void GraphSlam::addMatchEdges(int k, const Pose2& T_map_robot, const Eigen::Matrix3d& information) {
  std::vector<int> lately, before;
  for (const int other : map_keyframes_) {
    const bool is_late = std::abs(map_->path_m() - map_->keyframe(other).path_m) < options_.map_path_m;
    (is_late ? lately : before).push_back(other);
  }
  const bool are_two = !lately.empty() && !before.empty();
  const auto partners = partnersOf(k, map_keyframes_, T_map_robot);
  for (const auto* pass : {&lately, &before}) {
    Pose2 T = T_map_robot;
    Eigen::Matrix3d told = information;
    double share = static_cast<double>(std::max<size_t>(partners.size(), 1));
    std::vector<int> own;
    for (const int partner : partners)
      if (std::find(pass->begin(), pass->end(), partner) != pass->end()) own.push_back(partner);
    if (own.empty()) continue;
    if (are_two) {
      const auto matched = matchToPass(k, *pass, T_map_robot);
      if (!matched && pass == &before) continue;
      if (matched)
        T = matched->T_map_robot, told = matched->information, share = static_cast<double>(own.size());
    }
    for (const int partner : own) {
      posegraph::Edge edge;
      edge.from = partner, edge.to = k;
      edge.T_from_to = core::between(map_->pose(partner), T);
      edge.information = scanmatch::edgeInformation(told, T.phi) / share;
      map_->graph().addEdge(edge);
      map_->link(partner, k);
    }
  }
}

/// Keyframe k matched to these alone, from where it lies; nothing where that is another place.
std::optional<scanmatch::MatchResult> GraphSlam::matchToPass(int k, const std::vector<int>& pass,
                                                             const Pose2& T_map_robot) {
  pass_map_.clear(core::position(T_map_robot), kMapReach_m);
  for (const int other : pass) pass_map_.add(map_->keyframe(other).points, map_->pose(other), other);
  scanmatch::PosePrior flat;
  flat.mean = T_map_robot;
  flat.information.setIdentity();
  const auto matched =
      alignToSurfels(map_->keyframe(k).points, pass_map_, T_map_robot, flat, matchOptions(10));
  if (!isFollowed(matched.T_map_robot, T_map_robot)) return std::nullopt;
  if (matched.score >= options_.loop_confirm_score) return matched;
  // Of what lies beyond the pass nothing can be explained.
  const double telling = std::min(
      map_->toldBy(firstOf(pass, kAskedViewers), map_->keyframe(k).points, matched.T_map_robot).telling, 1.0);
  if (telling < kLeastTelling || matched.score < options_.loop_confirm_score * telling) return std::nullopt;
  return matched;
}

void GraphSlam::addKeyframe(const robot::Scan& scan, std::vector<PatchPoint> points, const Pose2& T_map_robot,
                            const Eigen::Matrix3d& information) {
  const int k = map_->graph().addNode(T_map_robot);
  map_->keyframes().push_back({map_->scan(), scan, std::move(points), map_->path_m(), -1,
                               by_wheels_.has_value(), false, -1, Eigen::Matrix3d::Zero(), noise_,
                               covariance_, scanmatch::rootOf(covariance_ + noise_)});
  map_->links().addKeyframe();
  if (k == 0) {
    map_->graph().setFixed(0);
  } else {
    map_->keyframes().back().odometry_edge = addOdometryEdge(k);
    if (doubt_.begins != k && map_->parts().back().begin != k) map_->link(anchor_, k);
    // What was driven on known ground is no way from one to the other.
    if (anchor_ != k - 1) map_->addClosure(anchor_, k);
    addMatchEdges(k, T_map_robot, information);
    noteMatch();
  }
  anchor_ = k;
  from_keyframe_.setZero();
  T_keyframe_robot_ = T_keyframe_hung_ = T_odometry_ = {};
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

void GraphSlam::finish() {
  if (map_->keyframes().empty()) return;
  completeClosing();
  if (options_.loops) joinRemainingParts();
  const auto first_new = std::find_if(map_->keyframes().begin(), map_->keyframes().end(),
                                      [](const Keyframe& one) { return one.scan != kOfEarlierRun; });
  if (options_.loops)
    loops_.searchRemainingLoops(static_cast<int>(first_new - map_->keyframes().begin()),
                                [this] { haveMoved(); });
  noteWhatStaysApart();
  if (options_.refine_rounds > 0) refine();
}

}  // namespace slam::graph
