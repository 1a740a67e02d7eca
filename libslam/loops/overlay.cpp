#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/part_finder.h"

/// A map of before that is held as a whole against the rest.
namespace slam::loops {
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

bool isHopeless(const keyframes::Overlay& one) {
  return one.told >= kPatience && one.fitting < kHopeless * one.told;
}

void sortByVotes(std::vector<keyframes::Overlay>& overlays) {
  std::stable_sort(
      overlays.begin(), overlays.end(),
      [](const keyframes::Overlay& a, const keyframes::Overlay& b) { return a.votes > b.votes; });
}

}  // namespace

std::optional<PartFinder::PlacedPart> PartFinder::placeOfPart(int first, int end, core::Progress& progress) {
  join_first_ = first, join_last_ = end - 1;
  std::vector<keyframes::Overlay> overlays;
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
  const auto best = std::max_element(
      overlays.begin(), overlays.end(),
      [](const keyframes::Overlay& a, const keyframes::Overlay& b) { return a.nats < b.nats; });
  if (best == overlays.end() || !fitsWell(*best)) return std::nullopt;
  double rival_nats = 0;
  for (const auto& other : overlays)
    if (map_->componentOf(other.place) == map_->componentOf(best->place) &&
        !isSame(placeAt(other, best->anchor), best->T_map_robot))
      rival_nats = std::max(rival_nats, other.nats);
  if (rival_nats > keyframes::twinShare(best->fits.diagonal_m()) * best->nats ||
      best->nats - rival_nats < keyframes::kAhead)
    return std::nullopt;
  PartPlace place;
  place.fitting = best->fitting;
  place.extent_m = best->fits.diagonal_m();
  place.ahead_nats = best->nats - rival_nats;
  const keyframes::Cursor& middle = best->placed[best->placed.size() / 2];
  keyframes::Hypothesis hypothesis;
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
bool PartFinder::fitsWell(const keyframes::Overlay& one) const {
  return one.is_judged && static_cast<int>(one.placed.size()) >= options_->loop_confirmations &&
         one.fits.diagonal_m() >= kExtent_m && one.fitting >= kFittingShare * one.told &&
         one.distinct >= options_->loop_distinctness;
}

/// Places of the map, beyond the part, where what was seen around one of its keyframes fits.
void PartFinder::lookFrom(int anchor, std::vector<keyframes::Overlay>& overlays,
                          const std::function<void()>& tell) {
  std::vector<PatchPoint> query;
  for (int k = anchor; k >= join_first_ && anchor - k < keyframes::kMostQueryKeyframes; --k) {
    if (map_->keyframe(anchor).path_m - map_->keyframe(k).path_m >= options_->loop_path_m) break;
    const Pose2 T_anchor_k = core::between(map_->pose(anchor), map_->pose(k));
    for (const auto& point : map_->keyframe(k).points) query.push_back(T_anchor_k * point);
  }
  const auto places = placesBeyond(map_->componentOf(anchor));
  for (const int place : places) {
    tell();
    for (int heading = 0; heading < keyframes::kHeadings; ++heading) {
      const auto found =
          matchAtPlace(query, place, map_->pose(anchor).phi + heading * keyframes::kHeadingStep_rad);
      if (!found) continue;
      const auto known = std::find_if(overlays.begin(), overlays.end(), [&](const keyframes::Overlay& one) {
        return isSame(placeAt(one, anchor), found->T_map_robot);
      });
      if (known == overlays.end()) {
        keyframes::Overlay one;
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
Pose2 PartFinder::placeAt(const keyframes::Overlay& one, int k) const {
  return one.T_map_robot * core::between(map_->pose(one.anchor), map_->pose(k));
}

/// Holds a place against the whole part, from where it was found to both sides.
void PartFinder::overlay(keyframes::Overlay& one, int first, int end) const {
  if (one.is_judged) return;
  one.is_judged = true;
  keyframes::Cursor cursor{one.anchor, one.T_map_robot};
  for (int k = one.anchor; k < end && !isHopeless(one); ++k) lay(one, cursor, k);
  cursor = {one.anchor, one.T_map_robot};
  for (int k = one.anchor - 1; k >= first && !isHopeless(one); --k) lay(one, cursor, k);
}

/// Moves on to keyframe k, as it fits there.
void PartFinder::lay(keyframes::Overlay& one, keyframes::Cursor& cursor, int k) const {
  const Pose2 expected = cursor.T_map_robot * core::between(map_->pose(cursor.at), map_->pose(k));
  cursor = {k, expected};
  const auto around =
      map_->keyframesNear(core::position(expected), map_->componentOf(one.place), keyframes::kJoinKeyframes);
  const auto viewers = keyframes::firstOf(around, keyframes::kViewers);
  const auto& points = map_->keyframe(k).points;
  const double telling = std::min(map_->toldBy(viewers, points, expected).telling, 1.0);
  if (telling < keyframes::kToldToJoin) return;
  const keyframes::LevelMaps& maps = map_->mapOf(around, core::position(expected));
  const auto matched = keyframes::match(points, maps, expected, keyframes::followedTo(expected), 0, false);
  const Pose2& T = matched.T_map_robot;
  const bool is_near = keyframes::isFollowed(T, expected);
  const double conflict = conflictOf(k - join_first_, viewers, is_near ? T : expected);
  ++one.told;
  one.nats += keyframes::kNatsPerScan *
              ((is_near ? matched.score : 0) - keyframes::kContradicted * conflict * telling);
  // Of what lies beyond the map nothing can be explained.
  if (!is_near || matched.score < options_->loop_confirm_score * telling || conflict >= kMostConflict) return;
  ++one.fitting;
  // What little is seen of the map does not say where it lies.
  if (matched.score < options_->loop_confirm_score) return;
  cursor.T_map_robot = T;
  one.distinct += keyframes::distinctness(points, maps, matched);
  one.fits.add(core::position(T));
  one.placed.push_back(cursor);
  map_->addLoopEdges(one.edges, around, k, matched.T_map_robot, maps.fine);
}

}  // namespace slam::loops
