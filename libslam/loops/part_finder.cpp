#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/part_finder.h"
#include "libslam/scanmatch/correlative_search.h"

namespace slam::loops {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// Points of a trail that are held against the map at each scan: what a search may cost is spread.
constexpr int kChecksPerScan = 3;
/// How far back a trail is asked, in points of it, and places that are followed at once.
constexpr int kLongestTrail = 40, kMostJoins = 12;
/// A place may fail kMostFailures times, and once more for every so many points that fit.
constexpr int kFittingPerFailure = 5;
/// And it was followed over this extent without failing, and fits over half of it: rooms that look alike are
/// smaller. So far where a point of the trail is by kDistinct more like its place than like those beside it;
/// less far where that is plainer, and the farther along a corridor or in a yard, which goes on like itself.
constexpr double kExtent_m = 4, kDistinct = 0.4, kShortest = 0.5, kLongest = 4;
/// Before a place is followed some points of the trail are asked whether the map contradicts it there.
constexpr int kFirstAsked = 6;
constexpr double kFirstConflict = 0.25;
/// Two places are the same.
constexpr double kSame_m = 0.5, kSame_rad = 0.1;
/// A trail is proved to lie at one place only: points that are asked, by how much less others hold it, and
/// how many are tried per scan.
constexpr size_t kProofPoints = 120;
constexpr double kProofMargin = 0.1;
constexpr double kTwin_m = 2, kTwin_rad = 0.5;
/// A twin that was followed and left behind counts no more when this one fits over so many times its extent.
constexpr double kRefuted = 2;
/// Points that have to fit, after a twin was found, before the next proof.
constexpr int kFitsBetweenProofs = 4;
constexpr int kProofsPerScan = 2;

bool isSame(const Pose2& a, const Pose2& b) {
  return core::distance(a, b) < kTwin_m && std::abs(core::angleDifference(a.phi, b.phi)) < kTwin_rad;
}

/// Over what extent a place has to be followed.
double extentToFollow_m(const keyframes::Join& join) {
  const double ratio = kDistinct * join.fitting / std::max(join.distinct, 1e-9);
  return kExtent_m * std::clamp(ratio * ratio, kShortest, kLongest);
}

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
  addJoin(place, matched->T_map_robot);
}

/// The place is followed from now on, unless it is already, or the trail contradicts it at once.
void PartFinder::addJoin(int place, const Pose2& T_map_robot) {
  const int last = trailSize() - 1;
  keyframes::Join join;
  join.place = join.old_keyframe = place;
  join.forth = join.back = {last, T_map_robot};
  join.back_to = std::max(0, last - kLongestTrail);
  join.places_left = static_cast<int>(places_.size()) - 1;
  join.fits = join.followed = {core::position(T_map_robot), core::position(T_map_robot)};
  if (isKnown(join) || !isPlausible(join)) return;
  holdAgainst(join, join.forth, last);
  if (join.fitting == 0) return;
  join.back.T_map_robot = join.forth.T_map_robot;
  if (static_cast<int>(joins_.size()) == kMostJoins) {
    const auto worst = std::min_element(joins_.begin(), joins_.end(),
                                        [](const keyframes::Join& a, const keyframes::Join& b) {
                                          return a.evidence * b.asked < b.evidence * a.asked;
                                        });
    joins_.erase(worst);
    // It may have been the one.
    for (auto& known : joins_) known.places_left = static_cast<int>(places_.size());
  }
  joins_.push_back(std::move(join));
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
  const int last = join.forth.at;
  double against = 0, telling = 0;
  for (int n = 0; n < kFirstAsked; ++n) {
    const int i = last - (last - join.back_to) * n / (kFirstAsked - 1);
    const Pose2 T = join.forth.T_map_robot * core::between(trailPose(last), trailPose(i));
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
    join.says[next] = {0, 1};
    return;
  }
  ++join.told;
  const keyframes::LevelMaps& maps = map_->mapOf(around, core::position(expected));
  const auto matched = keyframes::match(points, maps, expected, keyframes::followedTo(expected), 0, false);
  const Pose2& T = matched.T_map_robot;
  const double conflict = conflictOf(next, viewers, T);
  if (conflict >= options_->loop_conflict || !keyframes::isFollowed(T, expected)) {
    join.evidence += keyframes::kNatsPerScan * (matched.score - conflict);
    join.says[next] = {-keyframes::kNatsPerScan, 0};
    ++join.failures;
    return;
  }
  join.followed.add(core::position(expected));
  const double nats = keyframes::kNatsPerScan * (matched.score - conflict);
  join.says[next] = {nats, unknown};
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
      refute(*next);
      joins_.erase(next);
    }
  }
  keyframes::Join* best = decided();
  return best != nullptr && isProved(*best, component) ? best : nullptr;
}

/// A place that is left behind tells over what extent a wrong one can fit.
void PartFinder::refute(const keyframes::Join& join) {
  map_->note(core::JournalEvent::kDropped, join.fitting, join.old_keyframe);
  const double fits_m = join.placed.size() > 1 ? join.fits.diagonal_m() : 0;
  refuted_.push_back({join.forth.T_map_robot * core::inverse(trailPose(join.forth.at)), fits_m});
}

/// Whether another place was followed before, and fitted over much less than this one does.
bool PartFinder::isRefuted(const Pose2& T_map_robot, const keyframes::Join& join) const {
  return std::any_of(refuted_.begin(), refuted_.end(), [&](const keyframes::Refuted& refuted) {
    return isSame(refuted.T_map_trail * trailPose(join.forth.at), T_map_robot) &&
           join.fits.diagonal_m() >= kRefuted * refuted.fits_m;
  });
}

/// By how many nats a place is ahead of another, point by point of the trail. What the other was not asked
/// yet, and what its map says nothing of, may fit there.
double PartFinder::aheadOf(const keyframes::Join& join, const keyframes::Join& other) const {
  const double credit = is_lost_ ? 0 : keyframes::kNatsPerScan;
  double ahead = 0;
  for (const auto& [point, said] : join.says) {
    const auto rival = other.says.find(point);
    ahead += said.nats - (rival == other.says.end() ? keyframes::kNatsPerScan
                                                    : rival->second.nats + credit * rival->second.unknown);
  }
  return ahead;
}

/// Whether all of the trail was held against a place, and all of the map was looked at since it was found.
bool PartFinder::isReady(const keyframes::Join& join) const {
  return isCurrent(join) && join.places_left <= 0 && join.fitting >= options_->loop_confirmations &&
         join.distinct >= options_->loop_distinctness &&
         join.followed.diagonal_m() >= extentToFollow_m(join) &&
         2 * join.fits.diagonal_m() >= extentToFollow_m(join);
}

/// The place that no other can be as good as, if there is one.
keyframes::Join* PartFinder::decided() {
  for (auto& join : joins_) {
    const bool is_ahead =
        isReady(join) && std::all_of(joins_.begin(), joins_.end(), [&](const keyframes::Join& other) {
          return &other == &join || aheadOf(join, other) > keyframes::kAhead;
        });
    if (is_ahead) return &join;
  }
  return nullptr;
}

/// What of the trail fits, as it lies in the map, seen from its newest end.
std::vector<Point2> PartFinder::trailQuery(const keyframes::Join& join) const {
  std::vector<PatchPoint> query;
  const Pose2 T_last_map = core::inverse(join.forth.T_map_robot);
  for (const auto& fit : join.placed)
    for (const auto& point : trailPoints(fit.at)) {
      const PatchPoint seen = T_last_map * fit.T_map_robot * point;
      if (core::hypot(seen.x, seen.y) <= keyframes::kPlaceReach_m) query.push_back(seen);
    }
  return keyframes::searchPoints(query, kProofPoints);
}

/// Looks for other places of the map that hold the trail as a whole nearly as well; some are tried at each
/// scan, and what is found has to be followed and left behind first. True when all were tried.
bool PartFinder::isProved(keyframes::Join& join, int component) {
  const auto places = placesBeyond(component);
  const Pose2 T = join.forth.T_map_robot;
  const auto nearest = std::min_element(places.begin(), places.end(), [&](int a, int b) {
    return core::distance(map_->pose(a), T) < core::distance(map_->pose(b), T);
  });
  if (nearest == places.end() || join.fitting < join.proof_from) return false;
  const auto query = trailQuery(join);
  const auto here = searchBest(pyramidOf(*nearest), query, T, {2 * keyframes::kSearchCell_m, 0.02}, 0);
  if (!here) return false;
  const int all = static_cast<int>(places.size()) * keyframes::kHeadings;
  const double least =
      is_lost_ ? here->score - kProofMargin : keyframes::twinShare(join.fits.diagonal_m()) * here->score;
  std::vector<std::pair<int, Pose2>> others;
  for (int n = 0; n < kProofsPerScan && join.proved < all; ++n, ++join.proved) {
    const int place = places[static_cast<size_t>(join.proved / keyframes::kHeadings)];
    const Point2 centre = core::position(map_->pose(place));
    const auto there = searchBest(
        pyramidOf(place), query,
        {centre.x, centre.y, T.phi + join.proved % keyframes::kHeadings * keyframes::kHeadingStep_rad},
        {keyframes::kPlaceHalf_m, 0.5 * keyframes::kHeadingStep_rad}, least);
    if (there && !isSame(there->T_map_robot, T) && !isRefuted(there->T_map_robot, join))
      others.push_back({place, there->T_map_robot});
  }
  // In a finished map the robot is in one of its places, and it is enough to leave the others behind.
  if (!others.empty() && !is_lost_) {
    join.proved = 0;
    join.proof_from = join.fitting + kFitsBetweenProofs;
  }
  const bool is_proved = join.proved >= all && others.empty();
  for (const auto& [place, T_other] : others) addJoin(place, T_other);
  return is_proved;
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
