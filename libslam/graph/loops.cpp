#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/graph/loop_judge.h"
#include "libslam/graph/search.h"

namespace slam::graph {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// Travel to the next search, by the last one's window; never so far that two searches share no scan.
constexpr double kPausePerReach = 0.1;
constexpr double kDistinctShifts_m[] = {-1.5, -1, -0.6, -0.35, 0.35, 0.6, 1, 1.5};
constexpr double kDistinctKernel = 3;

}  // namespace

/// The shortest way from a keyframe to every earlier one: what the drift between them grows with.
std::vector<double> GraphSlam::pathTo(int k) const {
  std::vector<double> path_m;
  path_m.reserve(keyframes_.size());
  for (const auto& one : keyframes_) path_m.push_back(one.path_m);
  return shortestWays(path_m, closures_, k);
}

/// By how much a match explains more than the same moved along the direction of movement that it holds least:
/// what makes the place unlike its neighbours along a corridor.
double GraphSlam::distinctness(const std::vector<PatchPoint>& points, const LevelMaps& maps,
                               const scanmatch::MatchResult& matched) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> movement(matched.information.topLeftCorner<2, 2>());
  const Eigen::Vector2d weakest = movement.eigenvectors().col(0);
  const Pose2& T = matched.T_map_robot;
  const double here = surfelScore(points, maps.middle, T, kDistinctKernel, 1);
  double elsewhere = 0;
  for (const double shift_m : kDistinctShifts_m)
    elsewhere =
        std::max(elsewhere, surfelScore(points, maps.middle,
                                        {T.x + shift_m * weakest.x(), T.y + shift_m * weakest.y(), T.phi},
                                        kDistinctKernel, 1));
  return here - elsewhere;
}

/// Parts that begin after keyframe a, up to b.
int GraphSlam::gapsBetween(int a, int b) const {
  return static_cast<int>(std::count_if(parts_.begin(), parts_.end(),
                                        [&](const Part& part) { return part.begin > a && part.begin <= b; }));
}

/// The points of these keyframes, map frame.
std::vector<Point2> GraphSlam::placeAround(const std::vector<int>& keyframes) const {
  std::vector<Point2> place;
  for (const int k : keyframes)
    for (const auto& point : keyframe(k).points) place.push_back(graph_.pose(k) * position(point));
  return place;
}

/// A match of keyframe k to the nearest of `around`.
void GraphSlam::addLoopEdges(std::vector<posegraph::Edge>& edges, const std::vector<int>& around, int k,
                             const scanmatch::MatchResult& matched) const {
  const size_t partners = std::min<size_t>(around.size(), kConfirmEdges);
  for (size_t i = 0; i < partners; ++i) {
    posegraph::Edge edge;
    edge.from = around[i], edge.to = k;
    edge.T_from_to = core::between(graph_.pose(around[i]), matched.T_map_robot);
    edge.information = scanmatch::edgeInformation(matched.information, matched.T_map_robot.phi) /
                       static_cast<double>(kConfirmEdges);
    edge.kind = posegraph::EdgeKind::kLoop;
    edges.push_back(edge);
  }
}

/// Whether keyframe k by itself fits the old map where the hypothesis puts it; the hypothesis moves on to k
/// then. What of the scan lies beyond the old map neither fits nor fails.
void GraphSlam::confirm(Hypothesis& hypothesis, int k) const {
  const Pose2 expected =
      hypothesis.T_map_robot * core::between(graph_.pose(hypothesis.keyframe), graph_.pose(k));
  std::vector<int> around;
  for (const int old : keyframesAround(hypothesis.old_keyframe, core::position(expected), options_.map_path_m,
                                       options_.map_radius_m)) {
    const bool is_old = old < k && keyframe(k).path_m - keyframe(old).path_m > options_.map_path_m / 2;
    if (is_old && static_cast<int>(around.size()) < options_.map_keyframes) around.push_back(old);
  }
  if (around.empty()) {
    hypothesis.says[k] = {0, 1};
    ++hypothesis.failures;
    return;
  }
  const LevelMaps& maps = mapOf(around, core::position(expected));
  const auto& points = keyframe(k).points;
  const auto viewers = firstOf(around, kViewers);
  const auto matched = match(points, maps, expected, followedTo(expected), 0, false);
  const double conflict = meanConflict(viewers, matched.T_map_robot, points);
  const double unknown = 1 - std::min(toldBy(firstOf(around, kAskedViewers), points, expected).telling, 1.0);
  const bool is_there = conflict < options_.loop_conflict && isFollowed(matched.T_map_robot, expected);
  hypothesis.says[k] = {is_there ? kNatsPerScan * (matched.score - conflict) : 0, unknown};
  if (!is_there || matched.score < options_.loop_confirm_score) {
    hypothesis.failures += !is_there || matched.score + unknown < options_.loop_confirm_score;
    return;
  }
  hypothesis.evidence += distinctness(points, maps, matched);
  addLoopEdges(hypothesis.edges, around, k, matched);
  hypothesis.keyframe = k, hypothesis.old_keyframe = around.front();
  hypothesis.T_map_robot = matched.T_map_robot;
  ++hypothesis.confirmations;
}

/// Follows the hypotheses to the newest keyframe, accepts what is confirmed, and searches for more.
void GraphSlam::closeLoops() {
  if (closing_) return;
  const int k = lastKeyframe();
  for (size_t i = 0; i < hypotheses_.size();) {
    Hypothesis& hypothesis = hypotheses_[i];
    confirm(hypothesis, k);
    if (hypothesis.failures > kMostFailures) {
      note(core::JournalEvent::kDropped, hypothesis.confirmations, hypothesis.old_keyframe);
      hypotheses_.erase(hypotheses_.begin() + static_cast<long>(i));
    } else {
      ++i;
    }
  }
  LoopJudge judge([this] { return witnesses(); }, keyframes_);
  const auto confirmed = std::find_if(hypotheses_.begin(), hypotheses_.end(), [&](const Hypothesis& one) {
    return one.confirmations >= options_.loop_confirmations && one.evidence >= options_.loop_distinctness &&
           path_m_ - one.begun_m >= options_.loop_confirm_m && judge.isBest(one, hypotheses_);
  });
  if (confirmed != hypotheses_.end()) {
    const Hypothesis loop = *confirmed;
    hypotheses_.clear();
    if (accept(loop, judge)) return;
  }
  // A wide search is dear, and what it would find is still there some metres on.
  const double pause_m =
      std::max(options_.loop_every_m, std::min(kPausePerReach * searched_reach_m_, options_.loop_path_m / 2));
  if (path_m_ - searched_m_ < pause_m) return;
  searched_m_ = path_m_;
  int first = k;
  while (first > 0 && k - first < kMostQueryKeyframes &&
         path_m_ - keyframe(first - 1).path_m < options_.loop_path_m)
    --first;
  for (Hypothesis& found : findLoop(k, first, k)) follow(found);
}

/// A hypothesis about the newest keyframe joins those that are followed, unless one of them says the same.
void GraphSlam::follow(Hypothesis& found) {
  const int k = found.keyframe;
  for (const auto& known : hypotheses_) {
    const Pose2 expected = known.T_map_robot * core::between(graph_.pose(known.keyframe), graph_.pose(k));
    if (core::distance(expected, found.T_map_robot) < 0.5 &&
        std::abs(core::angleDifference(expected.phi, found.T_map_robot.phi)) < 0.1)
      return;
  }
  confirm(found, k);
  if (found.failures == 0) hypotheses_.push_back(found);
}

/// With the whole path known a place can be looked at from both sides, and what drift had carried out of
/// reach may have come near. From keyframe `first_searched` on: a map of before was searched then.
void GraphSlam::searchRemainingLoops(int first_searched) {
  hypotheses_.clear();
  const int n = graph_.nodeCount();
  double searched_m = -1e9;
  for (int k = first_searched; k < n; ++k) {
    const double at_m = keyframe(k).path_m;
    if (at_m - searched_m < 2 * options_.loop_every_m) continue;
    searched_m = at_m;
    int first = k, last = k;
    while (first > 0 && at_m - keyframe(first - 1).path_m < options_.loop_path_m / 2) --first;
    while (last + 1 < n && keyframe(last + 1).path_m - at_m < options_.loop_path_m / 2) ++last;
    std::vector<Hypothesis> places = findLoop(k, first, last);
    for (Hypothesis& forth : places) {
      Hypothesis back = forth;
      for (int i = k; i <= last; ++i) confirm(forth, i);
      for (int i = k - 1; i >= first; --i) confirm(back, i);
      forth.confirmations += back.confirmations, forth.evidence += back.evidence;
      forth.says.merge(back.says);
      forth.edges.insert(forth.edges.end(), back.edges.begin(), back.edges.end());
    }
    LoopJudge judge([this] { return witnesses(); }, keyframes_);
    const auto best = std::find_if(places.begin(), places.end(), [&](const Hypothesis& one) {
      return one.confirmations >= options_.loop_confirmations && 2 * one.confirmations >= last - first + 1 &&
             one.evidence >= options_.loop_distinctness && judge.isBest(one, places);
    });
    if (best != places.end() && accept(*best, judge)) completeClosing();
  }
}

/// Whether what was measured on the way allows for it.
bool GraphSlam::isAllowed(const Hypothesis& hypothesis, LoopJudge& judge) {
  if (componentOf(hypothesis.keyframe) != componentOf(hypothesis.old_keyframe)) return true;
  const double off = judge.innovation(hypothesis);
  if (off <= options_.loop_innovation) return true;
  note(core::JournalEvent::kRejected, off, hypothesis.old_keyframe);
  return false;
}

/// Its poses follow: see closing.cpp. `judge` as the keyframes stand.
bool GraphSlam::accept(const Hypothesis& hypothesis, LoopJudge& judge) {
  const int k = hypothesis.keyframe, old = hypothesis.old_keyframe;
  note(core::JournalEvent::kConfirmed, hypothesis.confirmations, old,
       "distinct by " + std::to_string(hypothesis.evidence));
  if (!isAllowed(hypothesis, judge)) return false;
  const double way_m = k > old ? pathTo(k)[static_cast<size_t>(old)] : pathTo(old)[static_cast<size_t>(k)];
  const int component = componentOf(k), old_component = componentOf(old);
  const bool joins = component != old_component;
  // The one that holds the map's origin stays.
  const bool old_moves = joins && component == 0;
  if (joins) {
    const Pose2 T_map_part = hypothesis.T_map_robot * core::inverse(graph_.pose(k));
    const Pose2 T = old_moves ? core::inverse(T_map_part) : T_map_part;
    for (int i = 0; i < graph_.nodeCount(); ++i)
      if (componentOf(i) == (old_moves ? old_component : component)) graph_.setPose(i, T * graph_.pose(i));
    forgetWheels();
    links_.measure(graph_.poses());
  }
  loop_begins_.push_back(static_cast<int>(graph_.edges().size()));
  for (const auto& edge : hypothesis.edges) graph_.addEdge(edge);
  note(core::JournalEvent::kAccepted, way_m, old);
  // What a loop ties to the rest needs no doubt.
  if (doubt_.begins > old && doubt_.begins <= k) endDoubt();
  if (joins) {
    const bool was_cut_off = isCutOff(lastKeyframe());
    joinComponents(component, old_component);
    const bool is_back = was_cut_off && !isCutOff(lastKeyframe());
    note(is_back ? core::JournalEvent::kRecovered : core::JournalEvent::kJoined,
         is_back ? hypothesis.evidence : way_m, old);
  }
  beginClosing(hypothesis, joins);
  return true;
}

/// After the keyframes have moved.
void GraphSlam::settle() {
  forgetWheels();
  links_.measure(graph_.poses());
  const auto covariances = keyframeCovariances();
  for (size_t i = 0; i < covariances.size(); ++i) {
    keyframes_[i].covariance = covariances[i];
    keyframes_[i].root = scanmatch::rootOf(covariances[i] + keyframes_[i].noise);
  }
  covariance_ = covariances[static_cast<size_t>(anchor_)];
  ++revision_;
}

}  // namespace slam::graph
