#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/part_finder.h"

namespace slam::loops {
namespace {

using core::Pose2;
using keyframes::Cursor;
using scanmatch::PatchPoint;

/// Points of a trail that are held against the map at each scan: what a search may cost is spread.
constexpr int kChecksPerScan = 3;
/// How far back a trail is asked, in points of it, and places that are followed at once.
constexpr int kLongestTrail = 40, kMostJoins = 12;
/// A place may fail kMostFailures times, and once more for every so many points that fit.
constexpr int kFittingPerFailure = 5;
/// Before a place is followed some points of the trail are asked whether the map contradicts it there.
constexpr int kFirstAsked = 6;
constexpr double kFirstConflict = 0.25;
/// Two places are the same.
constexpr double kSame_m = 0.5, kSame_rad = 0.1;

}  // namespace

/// The trail: keyframes of a part, or what a robot that is lost in a finished map has seen.
int PartFinder::trailSize() const {
  return is_lost_ ? static_cast<int>(trail_.size()) : join_last_ - join_first_ + 1;
}

const Pose2& PartFinder::trailPose(int i) const {
  return is_lost_ ? trail_[static_cast<size_t>(i)].T_trail_robot : map_->pose(join_first_ + i);
}

const std::vector<PatchPoint>& PartFinder::trailPoints(int i) const {
  return is_lost_ ? trail_[static_cast<size_t>(i)].points : map_->keyframe(join_first_ + i).points;
}

bool PartFinder::isCurrent(const keyframes::Join& join) const {
  return join.back.at <= join.back_to && join.forth.at == trailSize() - 1;
}

/// Looks whether the newest of the trail lies at the next place of the map beyond its part, in one of the
/// headings.
void PartFinder::lookAtNextPlace(int component) {
  const auto& places = placesBeyond(component);
  if (places.empty()) return;
  const size_t turn = places_tried_++;
  const int place = places[turn / keyframes::kHeadings % places.size()];
  if (turn % keyframes::kHeadings == 0)
    for (auto& join : joins_) --join.places_left;
  const int last = trailSize() - 1;
  std::vector<PatchPoint> query;
  double way_m = 0;
  for (int i = last; i >= 0 && last - i < keyframes::kMostQueryKeyframes && way_m < options_->loop_path_m;
       --i) {
    const Pose2 T_last_i = core::between(trailPose(last), trailPose(i));
    for (const auto& point : trailPoints(i)) query.push_back(T_last_i * point);
    if (i > 0) way_m += core::distance(trailPose(i), trailPose(i - 1));
  }
  // Headings of the trail, so that it does not matter how the robot turns meanwhile.
  const double heading =
      trailPose(last).phi + static_cast<double>(turn % keyframes::kHeadings) * keyframes::kHeadingStep_rad;
  const auto matched = matchAtPlace(query, place, heading);
  if (!matched) return;
  map_->note(core::JournalEvent::kFound, matched->score, place);
  addJoin(place, {last, matched->T_map_robot});
}

/// The place is followed from now on, from that point of the trail, unless it is already, or the trail
/// contradicts it at once. Too many are followed: the worst is not any more, unless it is the one to be kept.
PartFinder::Added PartFinder::addJoin(int place, const Cursor& found, const keyframes::Join* kept) {
  const int last = trailSize() - 1;
  keyframes::Join join;
  join.place = join.old_keyframe = place;
  join.forth = join.back = found;
  join.back_to = std::max(0, last - kLongestTrail);
  join.places_left = static_cast<int>(places_.size()) - 1;
  join.fits = join.followed = {core::position(found.T_map_robot), core::position(found.T_map_robot)};
  if (isKnown(join)) return Added::kKnown;
  if (!isPlausible(join)) return Added::kContradicted;
  holdAgainst(join, join.forth, found.at);
  if (join.fitting == 0) return Added::kFitsNot;
  join.back.T_map_robot = join.forth.T_map_robot;
  if (static_cast<int>(joins_.size()) == kMostJoins) {
    const auto worst = std::min_element(
        joins_.begin(), joins_.end(), [&](const keyframes::Join& a, const keyframes::Join& b) {
          return &a != kept && (&b == kept || a.evidence * b.asked < b.evidence * a.asked);
        });
    joins_.erase(worst);
    // It may have been the one.
    for (auto& known : joins_) known.places_left = static_cast<int>(places_.size());
  }
  joins_.push_back(std::move(join));
  return Added::kNew;
}

bool PartFinder::isKnown(const keyframes::Join& join) const {
  return std::any_of(joins_.begin(), joins_.end(), [&](const keyframes::Join& known) {
    const Pose2 expected =
        known.forth.T_map_robot * core::between(trailPose(known.forth.at), trailPose(join.forth.at));
    return core::distance(expected, join.forth.T_map_robot) < kSame_m &&
           std::abs(core::angleDifference(expected.phi, join.forth.T_map_robot.phi)) < kSame_rad;
  });
}

/// Whether the map does not contradict the trail on the whole.
bool PartFinder::isPlausible(const keyframes::Join& join) const {
  const int last = trailSize() - 1;
  double against = 0, telling = 0;
  for (int n = 0; n < kFirstAsked; ++n) {
    const int i = last - (last - join.back_to) * n / (kFirstAsked - 1);
    const Pose2 T = join.forth.T_map_robot * core::between(trailPose(join.forth.at), trailPose(i));
    const keyframes::Told told = map_->toldBy(
        map_->keyframesNear(core::position(T), map_->componentOf(join.place), keyframes::kAskedViewers),
        trailPoints(i), T);
    against += told.contradicted * told.telling;
    telling += told.telling;
    if (i == join.back_to) break;
  }
  return telling > 0 && against < kFirstConflict * telling;
}

/// How far a point of the trail and the map contradict each other at a pose: by the map's beams, and by the
/// point's own.
double PartFinder::conflictOf(int trail_point, const std::vector<int>& viewers,
                              const Pose2& T_map_robot) const {
  const double theirs = map_->meanConflict(viewers, T_map_robot, trailPoints(trail_point));
  if (is_lost_ || viewers.empty()) return theirs;
  const auto& seen = map_->keyframe(join_first_ + trail_point).seen;
  double its = 0;
  for (const int viewer : viewers)
    its +=
        keyframes::view(seen, core::between(T_map_robot, map_->pose(viewer)), map_->keyframe(viewer).points)
            .conflict();
  return std::max(theirs, its / static_cast<double>(viewers.size()));
}

/// The same of what was seen around a point of a part, by the part itself. Of a robot that is lost in a
/// finished map that is not known.
double PartFinder::contradictsItself(int trail_point) {
  if (is_lost_) return 0;
  const auto known = itself_.find(trail_point);
  if (known != itself_.end()) return known->second;
  const int k = join_first_ + trail_point;
  const Pose2& T = map_->pose(k);
  auto viewers = map_->keyframesNear(core::position(T), map_->componentOf(k), keyframes::kViewers + 1);
  viewers.erase(std::remove(viewers.begin(), viewers.end(), k), viewers.end());
  return itself_[trail_point] = conflictOf(trail_point, viewers, T);
}

/// Moves a place on to the next point of its trail.
void PartFinder::holdAgainst(keyframes::Join& join, keyframes::Cursor& cursor, int next) {
  const Pose2 expected = cursor.T_map_robot * core::between(trailPose(cursor.at), trailPose(next));
  const auto& points = trailPoints(next);
  cursor = {next, expected};
  ++join.asked;
  const auto around =
      map_->keyframesNear(core::position(expected), map_->componentOf(join.place), keyframes::kJoinKeyframes);
  const auto viewers = keyframes::firstOf(around, keyframes::kViewers);
  const double unknown = 1 - std::min(map_->toldBy(viewers, points, expected).telling, 1.0);
  if (1 - unknown < keyframes::kToldToJoin) {
    join.followed.add(core::position(expected));
    join.says[next] = {0, 0, 1};
    return;
  }
  ++join.told;
  const keyframes::LevelMaps& maps = map_->mapOf(around, core::position(expected));
  const auto matched = keyframes::match(points, maps, expected, keyframes::followedTo(expected), 0, false);
  const Pose2& T = matched.T_map_robot;
  const double conflict = conflictOf(next, viewers, T);
  const double nats = keyframes::kNatsPerScan * (matched.score - keyframes::kContradicted * conflict);
  const double itself = contradictsItself(next);
  join.against += conflict, join.against_itself += itself;
  if (conflict >= options_->loop_conflict + kAsItself * itself || !keyframes::isFollowed(T, expected)) {
    join.evidence += nats;
    join.says[next] = {0, std::max(conflict, 1 / keyframes::kContradicted), 0};
    ++join.failures;
    return;
  }
  join.followed.add(core::position(expected));
  join.says[next] = {matched.score, conflict, unknown};
  // Where the map ends much is new, and contradicts nothing.
  if (matched.score < options_->loop_confirm_score) return;
  join.evidence += nats;
  ++join.fitting;
  cursor.T_map_robot = T;
  join.score = matched.score;
  join.distinct += keyframes::distinctness(points, maps, matched);
  join.fits.add(core::position(T));
  join.placed.push_back({next, T});
  if (&cursor == &join.forth) join.old_keyframe = around.front();
  if (is_lost_) return;
  map_->addLoopEdges(join.edges, around, join_first_ + next, matched.T_map_robot, maps.fine);
}

/// One scan's share of the search. The place that the trail belongs to, when that is decided.
const keyframes::Join* PartFinder::workOnJoins(int component) {
  lookAtNextPlace(component);
  for (int n = 0; n < kChecksPerScan; ++n) {
    // The best that there is first; then those that are known least.
    auto next = joins_.end();
    for (auto join = joins_.begin(); join != joins_.end(); ++join) {
      if (isCurrent(*join)) continue;
      if (next == joins_.end() || (n == 0 ? join->evidence > next->evidence : join->asked < next->asked))
        next = join;
    }
    if (next == joins_.end()) break;
    if (next->back.at > next->back_to)
      holdAgainst(*next, next->back, next->back.at - 1);
    else
      holdAgainst(*next, next->forth, next->forth.at + 1);
    if (next->failures > keyframes::kMostFailures + next->fitting / kFittingPerFailure ||
        (next->told >= kFirstAsked && 4 * next->fitting < next->told)) {
      map_->note(core::JournalEvent::kDropped, next->fitting, next->old_keyframe);
      joins_.erase(next);
    }
  }
  keyframes::Join* best = decided();
  return best != nullptr && isProved(*best, component) ? best : nullptr;
}

std::optional<keyframes::Hypothesis> PartFinder::lookForPart(int first, int last) {
  join_first_ = first, join_last_ = last;
  const keyframes::Join* join = workOnJoins(map_->componentOf(first));
  if (join == nullptr) return std::nullopt;
  keyframes::Hypothesis loop;
  loop.keyframe = join_first_ + join->forth.at;
  loop.old_keyframe = join->old_keyframe;
  loop.T_map_robot = join->forth.T_map_robot;
  loop.begun_m = map_->path_m();
  loop.confirmations = join->fitting;
  loop.evidence = join->distinct;
  loop.edges = join->edges;
  return loop;
}

size_t PartFinder::mostShares(int component) {
  return size_t{4} * keyframes::kHeadings * placesBeyond(component).size() + kLongestTrail;
}

void PartFinder::beginTrail() {
  is_lost_ = true;
  trail_.clear();
  searchAnew();
}

void PartFinder::endTrail() {
  is_lost_ = false;
  trail_.clear();
  searchAnew();
}

std::optional<PartFinder::Found> PartFinder::lookForRobot(const Pose2& here,
                                                          const std::vector<PatchPoint>& points) {
  if (trail_.empty() || core::distance(trail_.back().T_trail_robot, here) > options_->keyframe_distance_m ||
      std::abs(core::angleDifference(trail_.back().T_trail_robot.phi, here.phi)) >
          options_->keyframe_angle_rad)
    trail_.push_back({here, points});
  const keyframes::Join* found = workOnJoins(kAnyComponent);
  if (found == nullptr) return std::nullopt;
  return Found{found->forth.T_map_robot * core::between(trailPose(found->forth.at), here), found->score};
}

}  // namespace slam::loops
