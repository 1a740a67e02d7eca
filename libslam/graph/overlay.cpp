#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/graph/matching.h"
#include "libslam/graph/part_finder.h"
#include "libslam/graph/search.h"

/// A map of before that is held as a whole against the rest.
namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

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

std::optional<PartFinder::PlacedPart> PartFinder::placeOfPart(int first, int end, core::Progress& progress) {
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
    if (map_->componentOf(other.place) == map_->componentOf(best->place) &&
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
      map_->keyframesNear(core::position(middle.T_map_robot), map_->componentOf(best->place), 1).front();
  hypothesis.T_map_robot = middle.T_map_robot;
  hypothesis.begun_m = map_->path_m();
  hypothesis.confirmations = place.fitting;
  hypothesis.evidence = best->distinct;
  hypothesis.edges = best->edges;
  return PlacedPart{hypothesis, place};
}

/// Whether a part fits over enough of the map.
bool PartFinder::fitsWell(const Overlay& one) const {
  return one.is_judged && static_cast<int>(one.placed.size()) >= options_->loop_confirmations &&
         one.fits.diagonal_m() >= kExtent_m && one.fitting >= kFittingShare * one.told &&
         one.distinct >= options_->loop_distinctness;
}

/// Places of the map, beyond the part, where what was seen around one of its keyframes fits.
void PartFinder::lookFrom(int anchor, std::vector<Overlay>& overlays, const std::function<void()>& tell) {
  std::vector<PatchPoint> query;
  for (int k = anchor; k >= join_first_ && anchor - k < kMostQueryKeyframes; --k) {
    if (map_->keyframe(anchor).path_m - map_->keyframe(k).path_m >= options_->loop_path_m) break;
    const Pose2 T_anchor_k = core::between(map_->pose(anchor), map_->pose(k));
    for (const auto& point : map_->keyframe(k).points) query.push_back(T_anchor_k * point);
  }
  const auto places = placesBeyond(map_->componentOf(anchor));
  for (const int place : places) {
    tell();
    for (int heading = 0; heading < kHeadings; ++heading) {
      const auto found = matchAtPlace(query, place, map_->pose(anchor).phi + heading * kHeadingStep_rad);
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
Pose2 PartFinder::placeAt(const Overlay& one, int k) const {
  return one.T_map_robot * core::between(map_->pose(one.anchor), map_->pose(k));
}

/// Holds a place against the whole part, from where it was found to both sides.
void PartFinder::overlay(Overlay& one, int first, int end) const {
  if (one.is_judged) return;
  one.is_judged = true;
  Cursor cursor{one.anchor, one.T_map_robot};
  for (int k = one.anchor; k < end && !isHopeless(one); ++k) lay(one, cursor, k);
  cursor = {one.anchor, one.T_map_robot};
  for (int k = one.anchor - 1; k >= first && !isHopeless(one); --k) lay(one, cursor, k);
}

/// Moves on to keyframe k, as it fits there.
void PartFinder::lay(Overlay& one, Cursor& cursor, int k) const {
  const Pose2 expected = cursor.T_map_robot * core::between(map_->pose(cursor.at), map_->pose(k));
  cursor = {k, expected};
  const auto around =
      map_->keyframesNear(core::position(expected), map_->componentOf(one.place), kJoinKeyframes);
  const auto viewers = firstOf(around, kViewers);
  const auto& points = map_->keyframe(k).points;
  const double telling = std::min(map_->toldBy(viewers, points, expected).telling, 1.0);
  if (telling < kToldToJoin) return;
  const LevelMaps& maps = map_->mapOf(around, core::position(expected));
  const auto matched = match(points, maps, expected, followedTo(expected), 0, false);
  const Pose2& T = matched.T_map_robot;
  const bool is_near = isFollowed(T, expected);
  const double conflict = conflictOf(k - join_first_, viewers, is_near ? T : expected);
  ++one.told;
  one.nats += kNatsPerScan * ((is_near ? matched.score : 0) - kContradicted * conflict * telling);
  // Of what lies beyond the map nothing can be explained.
  if (!is_near || matched.score < options_->loop_confirm_score * telling || conflict >= kMostConflict) return;
  ++one.fitting;
  // What little is seen of the map does not say where it lies.
  if (matched.score < options_->loop_confirm_score) return;
  cursor.T_map_robot = T;
  one.distinct += distinctness(points, maps, matched);
  one.fits.add(core::position(T));
  one.placed.push_back(cursor);
  map_->addLoopEdges(one.edges, around, k, matched.T_map_robot, maps.fine);
}

}  // namespace slam::graph
