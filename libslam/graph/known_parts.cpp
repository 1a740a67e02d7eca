#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/graph/search.h"

namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// Parts lie so far apart until they are joined that nothing sees from one into another.
constexpr double kApart_m = 1000;
/// How a keyframe lies to those around it in a map of before.
constexpr double kKnown_m = 0.02, kKnown_rad = 0.005;
/// Keyframes from which a part is searched for: how many keyframes apart, how many at most, and how many have
/// to agree before the search may end early.
constexpr int kLeastAnchorStep = 5, kMostAnchors = 24, kLeastAnchors = 3;
/// Places that are held against the whole part.
constexpr size_t kMostOverlays = 12;
/// Two places are the same: maps drift.
constexpr double kSame_m = 2, kSame_rad = 0.2;
/// What is contradicted says more than what is explained: ln(0.3 / 0.04) to ln(0.9 / 0.55), of how often a
/// point is either at a wrong place and at the right one, where some furniture was moved.
constexpr double kContradicted = 4;
/// A keyframe that contradicts the map by more does not fit; furniture may have been moved.
constexpr double kMostConflict = 0.2;
/// The part has to fit over this extent, and its keyframes of which the map says anything in this share.
constexpr double kExtent_m = 4, kLargeExtent_m = 10, kFittingShare = 0.5;
/// After so many keyframes a place where hardly one fits is left.
constexpr int kPatience = 10;
constexpr double kHopeless = 0.2;
/// Every so many keyframes are held against the other parts in the end.
constexpr int kJudgedStep = 2;

bool isSame(const Pose2& a, const Pose2& b) {
  return core::distance(a, b) < kSame_m && std::abs(core::angleDifference(a.phi, b.phi)) < kSame_rad;
}

bool isHopeless(const Overlay& one) {
  return one.told >= kPatience && one.fitting < kHopeless * one.told;
}

void sortByVotes(std::vector<Overlay>& overlays) {
  std::stable_sort(overlays.begin(), overlays.end(),
                   [](const Overlay& a, const Overlay& b) { return a.votes > b.votes; });
}

}  // namespace

void GraphSlam::addKnownKeyframe(const robot::Scan& scan, const Pose2& T_given_robot) {
  if (!records_.empty()) throw core::ContractError("GraphSlam: known keyframes come before the first scan");
  const int k = graph_.nodeCount();
  const bool begins_part = k > 0 && parts_.back().begin == k;
  const Pose2 T_map_robot =
      known_parts_.empty() ? T_given_robot : known_parts_.back().T_map_given * T_given_robot;
  if (begins_part) {
    known_parts_.back().T_given_first = T_given_robot;
    map_keyframes_.clear();
    path_m_ += kGapPath_m;
  } else {
    T_odometry_ = core::between(k == 0 ? Pose2{} : graph_.pose(k - 1), T_map_robot);
    path_m_ += core::hypot(T_odometry_.x, T_odometry_.y);
  }
  const bool loops = std::exchange(options_.loops, false);
  addKeyframe(scan, pointsOf(scan), T_map_robot, scanmatch::poseInformation(kKnown_m, kKnown_rad));
  if (begins_part) loosen(k);
  keyframes_.back().scan = kOfEarlierRun;
  options_.loops = loops;
}

void GraphSlam::beginKnownPart() {
  if (keyframes_.empty()) throw core::ContractError("GraphSlam: a part of no map");
  double right_m = 0;
  for (const auto& pose : graph_.poses()) right_m = std::max(right_m, pose.x);
  known_parts_.push_back({{right_m + kApart_m, 0, 0}, {}});
  beginPart(graph_.nodeCount());
}

int GraphSlam::endOfPart(size_t part) const {
  return part + 1 < parts_.size() ? parts_[part + 1].begin : graph_.nodeCount();
}

std::vector<PartPlace> GraphSlam::joinParts(core::Progress& progress) {
  if (!options_.loops) throw core::ContractError("GraphSlam: parts are not joined without loops");
  if (parts_.back().begin == graph_.nodeCount())
    throw core::ContractError("GraphSlam: a part without a keyframe");
  std::vector<PartPlace> places(known_parts_.size());
  // What finds no place in one part may find it in another that was joined since.
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (size_t p = 1; p < parts_.size(); ++p) {
      if (componentOf(parts_[p].begin) == 0) continue;
      const auto found = placeOfPart(parts_[p].begin, endOfPart(p), progress);
      if (!found) continue;
      places[p - 1] = *found;
      goes_on = true;
    }
  }
  searchRemainingLoops(0);
  if (options_.refine_rounds > 0) refine();
  for (size_t p = 1; p < parts_.size(); ++p) judge(p, places[p - 1]);
  return places;
}

/// Looks for the keyframes [first, end) from some of them in all of the map that is not joined to them. Every
/// place that is found holds for the whole part: the places that several of them agree on are held against
/// all of it, and the part is joined where it fits over a large extent and no other place is nearly as good.
std::optional<PartPlace> GraphSlam::placeOfPart(int first, int end, core::Progress& progress) {
  join_first_ = first, join_last_ = end - 1;
  std::vector<Overlay> overlays;
  const int anchors = std::clamp((end - first) / kLeastAnchorStep, 1, kMostAnchors);
  for (int n = 0; n < anchors; ++n) {
    lookFrom(first + (end - 1 - first) * (n + 1) / anchors, overlays,
             [&] { progress.update(static_cast<double>(n) / anchors, 0); });
    // A place that so much speaks for needs no further witness; the others are held against it all the same.
    if (n + 1 < kLeastAnchors) continue;
    sortByVotes(overlays);
    if (overlays.empty() || overlays[0].votes < kLeastAnchors) continue;
    overlay(overlays[0], first, end);
    if (overlays[0].fits.diagonal_m() >= kLargeExtent_m && fitsWell(overlays[0])) break;
  }
  sortByVotes(overlays);
  if (overlays.size() > kMostOverlays) overlays.resize(kMostOverlays);
  for (auto& one : overlays) {
    overlay(one, first, end);
    progress.update(1, 0);
  }
  const auto best = std::max_element(overlays.begin(), overlays.end(),
                                     [](const Overlay& a, const Overlay& b) { return a.nats < b.nats; });
  if (best == overlays.end() || !fitsWell(*best)) return std::nullopt;
  double rival_nats = 0;
  for (const auto& other : overlays)
    if (componentOf(other.place) == componentOf(best->place) &&
        !isSame(placeAt(other, best->anchor), best->T_map_robot))
      rival_nats = std::max(rival_nats, other.nats);
  if (rival_nats > twinShare(best->fits.diagonal_m()) * best->nats || best->nats - rival_nats < kAhead)
    return std::nullopt;
  PartPlace place;
  place.fitting = best->fitting;
  place.extent_m = best->fits.diagonal_m();
  place.ahead_nats = best->nats - rival_nats;
  const Cursor& middle = best->placed[best->placed.size() / 2];
  Hypothesis hypothesis;
  hypothesis.keyframe = middle.at;
  hypothesis.old_keyframe =
      keyframesNear(core::position(middle.T_map_robot), componentOf(best->place), 1).front();
  hypothesis.T_map_robot = middle.T_map_robot;
  hypothesis.begun_m = path_m_;
  hypothesis.confirmations = place.fitting;
  hypothesis.evidence = best->distinct;
  hypothesis.edges = best->edges;
  LoopJudge judge([this] { return witnesses(); }, keyframes_);
  if (!accept(hypothesis, judge)) return std::nullopt;
  completeClosing();
  return place;
}

/// Whether a part fits over enough of the map.
bool GraphSlam::fitsWell(const Overlay& one) const {
  return one.is_judged && static_cast<int>(one.placed.size()) >= options_.loop_confirmations &&
         one.fits.diagonal_m() >= kExtent_m && one.fitting >= kFittingShare * one.told &&
         one.distinct >= options_.loop_distinctness;
}

/// Places of the map, beyond the part, where what was seen around one of its keyframes fits.
void GraphSlam::lookFrom(int anchor, std::vector<Overlay>& overlays, const std::function<void()>& tell) {
  std::vector<PatchPoint> query;
  for (int k = anchor; k >= join_first_ && anchor - k < kMostQueryKeyframes; --k) {
    if (keyframe(anchor).path_m - keyframe(k).path_m >= options_.loop_path_m) break;
    const Pose2 T_anchor_k = core::between(graph_.pose(anchor), graph_.pose(k));
    for (const auto& point : keyframe(k).points) query.push_back(T_anchor_k * point);
  }
  const auto places = placesBeyond(componentOf(anchor));
  for (const int place : places) {
    tell();
    for (int heading = 0; heading < kHeadings; ++heading) {
      const auto found = matchAtPlace(query, place, graph_.pose(anchor).phi + heading * kHeadingStep_rad);
      if (!found) continue;
      const auto known = std::find_if(overlays.begin(), overlays.end(), [&](const Overlay& one) {
        return isSame(placeAt(one, anchor), found->T_map_robot);
      });
      if (known == overlays.end()) {
        Overlay one;
        one.anchor = one.last_voter = anchor, one.place = place;
        one.T_map_robot = found->T_map_robot;
        overlays.push_back(std::move(one));
      } else if (known->last_voter != anchor) {
        known->last_voter = anchor;
        ++known->votes;
      }
    }
  }
}

/// Where a keyframe lies if the part lies so.
Pose2 GraphSlam::placeAt(const Overlay& one, int k) const {
  return one.T_map_robot * core::between(graph_.pose(one.anchor), graph_.pose(k));
}

/// Holds a place against the whole part, from where it was found to both sides.
void GraphSlam::overlay(Overlay& one, int first, int end) const {
  if (one.is_judged) return;
  one.is_judged = true;
  Cursor cursor{one.anchor, one.T_map_robot};
  for (int k = one.anchor; k < end && !isHopeless(one); ++k) lay(one, cursor, k);
  cursor = {one.anchor, one.T_map_robot};
  for (int k = one.anchor - 1; k >= first && !isHopeless(one); --k) lay(one, cursor, k);
}

/// Moves on to keyframe k, as it fits there.
void GraphSlam::lay(Overlay& one, Cursor& cursor, int k) const {
  const Pose2 expected = cursor.T_map_robot * core::between(graph_.pose(cursor.at), graph_.pose(k));
  cursor = {k, expected};
  const auto around = keyframesNear(core::position(expected), componentOf(one.place), kJoinKeyframes);
  const auto viewers = firstOf(around, kViewers);
  const auto& points = keyframe(k).points;
  const double telling = std::min(toldBy(viewers, points, expected).telling, 1.0);
  if (telling < kToldToJoin) return;
  const LevelMaps& maps = mapOf(around, core::position(expected));
  const auto matched = match(points, maps, expected, followedTo(expected), 0, false);
  const Pose2& T = matched.T_map_robot;
  const bool is_near = isFollowed(T, expected);
  const double conflict = conflictOf(k - join_first_, viewers, is_near ? T : expected);
  ++one.told;
  one.nats += kNatsPerScan * ((is_near ? matched.score : 0) - kContradicted * conflict * telling);
  // Of what lies beyond the map nothing can be explained.
  if (!is_near || matched.score < options_.loop_confirm_score * telling || conflict >= kMostConflict) return;
  ++one.fitting;
  // What little is seen of the map does not say where it lies.
  if (matched.score < options_.loop_confirm_score) return;
  cursor.T_map_robot = T;
  one.distinct += distinctness(points, maps, matched);
  one.fits.add(core::position(T));
  one.placed.push_back(cursor);
  addLoopEdges(one.edges, around, k, matched);
}

/// What the keyframes of a part and those of the others say of each other, as they lie in the end.
void GraphSlam::judge(size_t part, PartPlace& place) const {
  const int first = parts_[part].begin, end = endOfPart(part);
  place.is_joined = componentOf(first) == 0;
  place.T_map_part = graph_.pose(first) * core::inverse(known_parts_[part - 1].T_given_first);
  int judged = 0, sharing = 0;
  double told = 0, against = 0;
  for (int k = first; k < end; k += kJudgedStep) {
    ++judged;
    std::vector<int> viewers;
    for (const int other : keyframesWithin(core::position(graph_.pose(k)), options_.map_radius_m))
      if ((other < first || other >= end) && static_cast<int>(viewers.size()) < kAskedViewers)
        viewers.push_back(other);
    const Told said = toldBy(viewers, keyframe(k).points, graph_.pose(k), &keyframe(k).seen);
    if (said.telling < kToldToJoin) continue;
    ++sharing;
    told += said.telling;
    against += said.telling * said.contradicted;
  }
  place.shared = static_cast<double>(sharing) / judged;
  place.contradicted = told > 0 ? against / told : 0;
}

}  // namespace slam::graph
