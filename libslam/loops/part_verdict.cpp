#include <algorithm>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/part_finder.h"
#include "libslam/scanmatch/correlative_search.h"

/// Which of the places that are followed a trail belongs to, if that can be told.
namespace slam::loops {
namespace {

using core::Point2;
using core::Pose2;
using keyframes::Join;
using scanmatch::PatchPoint;

/// A place was followed over this extent without failing, and fits over half of it: rooms that look alike are
/// smaller. So far where a point of the trail is by kDistinct more like its place than like those beside it;
/// less far where that is plainer, and the farther along a corridor or in a yard, which goes on like itself.
constexpr double kExtent_m = 3, kDistinct = 0.4, kShortest = 0.5, kLongest = 4;
/// Of the points of the trail that the map tells anything of, this share has to fit; more where the map has
/// twins of the place, even such that beams contradict: there places look alike. Of 48 drives in a
/// bare hospital 11 were joined wrongly with a share of 0.4, 5 so (benchmarks/kidnapped, seeds 14100 and
/// 15100, on which it was chosen).
constexpr double kFittingShare = 0.8, kFittingBesideTwins = 0.95;
/// A trail is proved to lie at one place only: points that are asked, by how much less others hold it, and
/// how many are tried per scan.
constexpr size_t kProofPoints = 120;
constexpr double kProofMargin = 0.1;
constexpr int kProofsPerScan = 2;
constexpr double kTwin_m = 2, kTwin_rad = 0.5;
/// Points of the trail at which a twin may be followed from.
constexpr int kStarts = 6;

bool isSame(const Pose2& a, const Pose2& b) {
  return core::distance(a, b) < kTwin_m && std::abs(core::angleDifference(a.phi, b.phi)) < kTwin_rad;
}

/// Over what extent a place has to be followed.
double extentToFollow_m(const Join& join) {
  const double ratio = kDistinct * join.fitting / std::max(join.distinct, 1e-9);
  return kExtent_m * std::clamp(ratio * ratio, kShortest, kLongest);
}

}  // namespace

/// Whether two places of the trail are the same, where it has come to.
bool PartFinder::areSame(const Pose2& T_map_trail, const Pose2& T_map_other) const {
  const Pose2& newest = trailPose(trailSize() - 1);
  return isSame(T_map_trail * newest, T_map_other * newest);
}

/// By how many nats a place is ahead of another, point by point of the trail. What the other was not asked
/// yet, and what its map says nothing of, may fit there as it does here.
double PartFinder::aheadOf(const Join& join, const Join& other) const {
  double ahead = 0;
  for (const auto& [point, here] : join.says) {
    const auto known = other.says.find(point);
    const bool is_asked = known != other.says.end();
    const keyframes::Answer there = is_asked ? known->second : keyframes::Answer{0, 0, 1};
    const double may_fit = is_asked && is_lost_ ? 0 : there.unknown;
    const double explained = std::max(there.explained, std::min(there.explained + may_fit, here.explained));
    ahead += here.explained - explained - keyframes::kContradicted * (here.contradicted - there.contradicted);
  }
  return keyframes::kNatsPerScan * ahead;
}

bool PartFinder::isContradicted(const Join& join) const {
  return !is_lost_ && join.against > kAsItself * join.against_itself + kMoreThanItself * join.told;
}

/// Whether all of the trail was held against a place, and all of the map was looked at since it was found.
bool PartFinder::isReady(const Join& join) const {
  return isCurrent(join) && join.places_left <= 0 && !isContradicted(join) &&
         join.fitting >= options_->loop_confirmations && join.fitting >= kFittingShare * join.told &&
         join.distinct >= options_->loop_distinctness &&
         join.followed.diagonal_m() >= extentToFollow_m(join) &&
         2 * join.fits.diagonal_m() >= extentToFollow_m(join);
}

/// The place that no other can be as good as, if there is one.
Join* PartFinder::decided() {
  for (auto& join : joins_) {
    const bool is_ahead = isReady(join) && std::all_of(joins_.begin(), joins_.end(), [&](const Join& other) {
                            return &other == &join || aheadOf(join, other) > keyframes::kAhead;
                          });
    if (is_ahead) return &join;
  }
  return nullptr;
}

/// What of the trail fits, as it lies in the map, seen from its newest end.
std::vector<PatchPoint> PartFinder::whatFits(const Join& join) const {
  std::vector<PatchPoint> all;
  const Pose2 T_last_map = core::inverse(join.forth.T_map_robot);
  for (const auto& fit : join.placed)
    for (const auto& point : trailPoints(fit.at)) {
      const PatchPoint seen = T_last_map * fit.T_map_robot * point;
      if (core::hypot(seen.x, seen.y) <= keyframes::kPlaceReach_m) all.push_back(seen);
    }
  return all;
}

/// Follows a twin of a place, too, from one of the points of the trail that fit there, unless it is told
/// apart at once.
void PartFinder::followTwin(const Join& join, int place, const Pose2& T_map_robot) {
  const auto matched = map_->matchFreely(keyframes::thinned(whatFits(join), keyframes::kQueryMatchSpacing_m),
                                         map_->keyframesAtPlace(place), T_map_robot);
  const Pose2 T_twin_map = matched.T_map_robot * core::inverse(join.forth.T_map_robot);
  const size_t all = join.placed.size();
  for (size_t n = 0; n < std::min<size_t>(kStarts, all); ++n) {
    const keyframes::Cursor& fit = join.placed[all - 1 - n * (all - 1) / kStarts];
    if (addJoin(place, {fit.at, T_twin_map * fit.T_map_robot}, &join) != Added::kFitsNot) return;
  }
}

/// Looks for other places of the map that hold the trail as a whole nearly as well; some are tried at each
/// scan, and what is found has to be followed and left behind first. True when all were tried.
bool PartFinder::isProved(Join& join, int component) {
  const auto places = placesBeyond(component);
  const Pose2 T = join.forth.T_map_robot;
  const auto nearest = std::min_element(places.begin(), places.end(), [&](int a, int b) {
    return core::distance(map_->pose(a), T) < core::distance(map_->pose(b), T);
  });
  if (nearest == places.end()) return false;
  const int all = static_cast<int>(places.size()) * keyframes::kHeadings;
  // In a finished map the robot is in one of its places, and it is enough to leave the others behind.
  const auto standsOut = [&] {
    return is_lost_ || join.twins.empty() || join.fitting >= kFittingBesideTwins * join.told;
  };
  if (join.proved >= all) return standsOut();
  const auto query = keyframes::searchPoints(whatFits(join), kProofPoints);
  const auto here = searchBest(pyramidOf(*nearest), query, T, {2 * keyframes::kSearchCell_m, 0.02}, 0);
  if (!here) return false;
  const double least =
      is_lost_ ? here->score - kProofMargin : keyframes::twinShare(join.fits.diagonal_m()) * here->score;
  bool is_new = false;
  for (int n = 0; n < kProofsPerScan && join.proved < all; ++n, ++join.proved) {
    const int place = places[static_cast<size_t>(join.proved / keyframes::kHeadings)];
    const Point2 centre = core::position(map_->pose(place));
    const auto there = searchBest(
        pyramidOf(place), query,
        {centre.x, centre.y, T.phi + join.proved % keyframes::kHeadings * keyframes::kHeadingStep_rad},
        {keyframes::kPlaceHalf_m, 0.5 * keyframes::kHeadingStep_rad}, least);
    if (!there || isSame(there->T_map_robot, T)) continue;
    const Pose2 T_map_trail = there->T_map_robot * core::inverse(trailPose(join.forth.at));
    if (std::any_of(join.twins.begin(), join.twins.end(),
                    [&](const Pose2& known) { return areSame(known, T_map_trail); }))
      continue;
    is_new = true;
    followTwin(join, place, there->T_map_robot);
    join.twins.push_back(T_map_trail);
  }
  return join.proved >= all && !is_new && standsOut();
}

}  // namespace slam::loops
