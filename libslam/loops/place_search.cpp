#include "libslam/loops/place_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::loops {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// The search turns by this much at least, and more per metre of path.
constexpr double kSearchTurn_rad = 0.1, kSearchTurnPerMetre_rad = 0.002, kSearchTurnMost_rad = 0.6;
/// Places tried in one search.
constexpr int kMostPlaces = 2;
/// Points that are searched with, at most.
constexpr size_t kMostQueryPoints = 150;
/// Windows up to this reach, of views of which half lies this near, are searched on the finest raster; and
/// how much coarser it may become.
constexpr double kFineReach_m = 16, kFineView_m = 8, kCoarsest = 2;
/// Another place of a window is one if it lies so far from the best, and explains such a share of what that
/// does: where the old map ends, what is new may hide the right place.
constexpr double kRivalApart_m = 1, kRivalShare = 0.6;
/// So near to where the way there has it another place is looked for by itself.
constexpr double kLikelyReach_m = 4;
/// A robot that seemed to be kidnapped may have driven on where it was: a place of another part is searched
/// for, too, this near to where odometry has it, and farther by what drift allows.
constexpr double kNoGap_m = 0.5;

/// What one value of a pyramid costs, and one point drawn in it; and a match to a map, with each point of it:
/// in multiplications.
constexpr double kWorkPerValue = 3, kWorkPerDrawn = 500, kWorkPerMatch = 1e6, kWorkPerMatched = 200;

/// Half of the points lie within this distance of the robot.
double viewRadius(const std::vector<Point2>& points) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const auto& p : points) distances.push_back(core::hypot(p.x, p.y));
  return core::middleValue(std::move(distances));
}

}  // namespace

/// How far it is from its keyframe to each of the old ones.
void PlaceSearch::measureWays(int k) {
  search_.keyframe = k;
  search_.way_m = map_->pathTo(k);
  const int component = map_->componentOf(k);
  for (int old = 0; old < k; ++old)
    if (map_->componentOf(old) != component)
      search_.way_m[static_cast<size_t>(old)] = map_->keyframe(k).path_m - map_->keyframe(old).path_m -
                                                map_->gapsBetween(old, k) * keyframes::kGapPath_m;
  search_.is_local.assign(map_->keyframes().size(), 0);
  for (const int local : map_->keyframesLinkedWith(k, options_->map_path_m))
    search_.is_local[static_cast<size_t>(local)] = 1;
}

/// The scans of the keyframes [first, last].
void PlaceSearch::gatherQuery(int first, int last) {
  std::vector<PatchPoint> query;
  for (int i = last; i >= first; --i) {
    const Pose2 T_k_i = core::between(map_->pose(search_.keyframe), map_->pose(i));
    for (const auto& point : map_->keyframe(i).points) query.push_back(T_k_i * point);
  }
  search_.points = keyframes::searchPoints(query, kMostQueryPoints);
  search_.match_points = keyframes::thinned(query, keyframes::kQueryMatchSpacing_m);
  search_.view_m = viewRadius(search_.points);
}

double PlaceSearch::reachOf(int old) const {
  const double least_m =
      map_->componentOf(old) == map_->componentOf(search_.keyframe) ? options_->loop_reach_m : kNoGap_m;
  return std::min(least_m + options_->loop_reach_per_m * search_.way_m[static_cast<size_t>(old)],
                  options_->loop_reach_most_m);
}

/// Old keyframes that drift could have carried apart from it, the nearest first.
void PlaceSearch::listCandidates() {
  const int k = search_.keyframe;
  std::vector<std::pair<double, int>> by_distance;
  for (int old = 0; old < k; ++old) {
    if (search_.is_local[static_cast<size_t>(old)] || !map_->mayBeMatchedTo(old)) continue;
    const double away_m = core::distance(map_->pose(old), map_->pose(k));
    if (away_m < reachOf(old) + 1) by_distance.push_back({away_m, old});
  }
  std::sort(by_distance.begin(), by_distance.end());
  candidates_.clear();
  candidates_.reserve(by_distance.size());
  for (const auto& [away_m, old] : by_distance) candidates_.push_back(old);
}

void PlaceSearch::begin(int keyframe, int first, int last) {
  found_.clear(), has_found_ = false;
  stage_ = Stage::kPlace;
  measureWays(keyframe);
  listCandidates();
  if (candidates_.empty()) return;
  gatherQuery(first, last);
  is_tried_.assign(map_->keyframes().size(), 0);
  next_ = 0, places_ = 0;
  reach_m_ = 0;
}

/// Goes to the next old keyframe that was not around another one. False: there is none.
bool PlaceSearch::nextPlace() {
  while (next_ < candidates_.size() && is_tried_[static_cast<size_t>(candidates_[next_])]) ++next_;
  if (next_ == candidates_.size() || ++places_ > kMostPlaces) return false;
  old_ = candidates_[next_++];
  const core::Point2 centre = core::position(map_->pose(old_));
  // Those that came since the search began are not looked at: the newest are local.
  const auto isNew = [&](int k) { return static_cast<size_t>(k) >= is_tried_.size(); };
  for (const int tried : map_->keyframesLinkedWith(old_, options_->map_path_m))
    if (!isNew(tried)) is_tried_[static_cast<size_t>(tried)] = 1;
  around_ = map_->keyframesAround(old_, centre, keyframes::kPlacePath_m, keyframes::kPlaceRadius_m);
  around_.erase(
      std::remove_if(around_.begin(), around_.end(),
                     [&](int a) { return isNew(a) || search_.is_local[static_cast<size_t>(a)] != 0; }),
      around_.end());
  around_ = keyframes::firstOf(std::move(around_), options_->map_keyframes);
  preparePlace();
  reach_m_ = std::max(reach_m_, place_->window.half_xy_m);
  return true;
}

/// What is looked for there, and on which raster.
void PlaceSearch::preparePlace() {
  const double reach_m = reachOf(old_);
  // A wide window is searched on a coarser raster: it costs as its cube. So is a wide view: the angle
  // between two beams leaves it no finer detail, and every turn that it tells apart costs.
  place_->coarser =
      std::clamp(std::max(reach_m / kFineReach_m, search_.view_m / kFineView_m), 1.0, kCoarsest);
  place_->points = map_->placeAround(around_);
  place_->is_drawn = false;
  place_->query = search_.points;
  place_->centre = map_->pose(search_.keyframe);
  place_->window = {
      reach_m, std::min(kSearchTurn_rad + kSearchTurnPerMetre_rad * search_.way_m[static_cast<size_t>(old_)],
                        kSearchTurnMost_rad)};
}

bool PlaceSearch::Place::advance(double& work) {
  if (!is_drawn) {
    pyramid.build(points, coarser * keyframes::kSearchCell_m, coarser * keyframes::kSearchSigma_m,
                  keyframes::kSearchLevels);
    work -= kWorkPerDrawn * static_cast<double>(points.size()) +
            kWorkPerValue * static_cast<double>(pyramid.size());
    points.clear();
    is_drawn = true;
    if (!(work > 0)) return false;
  }
  if (!pieces) pieces.emplace(pyramid, query, centre, window, least_score);
  return pieces->advance(work);
}

void PlaceSearch::searchOn(double least_score) {
  place_->least_score = least_score;
  place_->pieces.reset();
  looking_.emplace([place = place_](double& left) { return place->advance(left); }, where_);
}

bool PlaceSearch::advance(double work, const Known& isKnown) {
  for (bool has_worked = false; stage_ != Stage::kNone; has_worked = true) {
    if (stage_ == Stage::kPlace) {
      // A place begins with a scan's whole work: what its keyframes saw is gathered at once.
      if (has_worked && work < std::numeric_limits<double>::infinity()) return false;
      if (has_found_ || candidates_.empty() || !nextPlace()) {
        stage_ = Stage::kNone;
        break;
      }
      searchOn(options_->loop_search_score);
      stage_ = Stage::kBest;
    } else {
      if (!looking_->advance(work)) return false;
      thread_s_ += looking_->threadSeconds();
      const auto result = place_->pieces->best();
      if (stage_ == Stage::kBest) {
        stage_ = noteBest(result, isKnown, work);
      } else if (stage_ == Stage::kRival) {
        stage_ = noteRival(result, isKnown, work);
      } else {
        if (result) add(result->T_map_robot, 0, isKnown, work);
        stage_ = Stage::kPlace;
      }
    }
  }
  looking_.reset();
  return true;
}

PlaceSearch::Stage PlaceSearch::noteBest(const std::optional<scanmatch::SearchResult>& best,
                                         const Known& isKnown, double& work) {
  if (!best) return Stage::kPlace;
  map_->note(core::JournalEvent::kSearched, best->score, old_);
  best_ = *best;
  if (!add(best_.T_map_robot, options_->loop_score, isKnown, work)) return Stage::kPlace;
  place_->window.apart_m = kRivalApart_m, place_->window.not_at = core::position(best_.T_map_robot);
  searchOn(kRivalShare * best_.score);
  return Stage::kRival;
}

PlaceSearch::Stage PlaceSearch::noteRival(const std::optional<scanmatch::SearchResult>& rival,
                                          const Known& isKnown, double& work) {
  if (!rival) return Stage::kPlace;
  add(rival->T_map_robot, 0, isKnown, work);
  // One that the way there makes likelier may be at the edge of the map, where less is explained.
  const Pose2& here = map_->pose(search_.keyframe);
  place_->window.half_xy_m =
      std::min(core::distance(best_.T_map_robot, here) - kRivalApart_m, kLikelyReach_m);
  if (place_->window.half_xy_m <= 0 || core::distance(rival->T_map_robot, here) < place_->window.half_xy_m)
    return Stage::kPlace;
  searchOn(kRivalShare * best_.score);
  return Stage::kLikelier;
}

/// Whether what was found is a place: known already, or confirmed by a match.
bool PlaceSearch::add(const Pose2& T_found, double least_score, const Known& isKnown, double& work) {
  if (isKnown(T_found)) return true;
  work -= kWorkPerMatch;
  for (const int k : around_) work -= kWorkPerMatched * static_cast<double>(map_->keyframe(k).points.size());
  const auto place = matchAt(T_found, least_score);
  if (place) found_.push_back(*place), has_found_ = true;
  return place.has_value();
}

/// A place that was found around an old keyframe, if its map, matched, explains what is searched for.
std::optional<keyframes::Hypothesis> PlaceSearch::matchAt(const Pose2& T_found, double least_score) {
  const auto matched = map_->matchFreely(search_.match_points, around_, T_found, place_->coarser > 1);
  std::vector<int> viewers;
  for (const int a : around_)
    if (core::distance(map_->pose(a), matched.T_map_robot) <= keyframes::kViewerDistance_m)
      viewers.push_back(a);
  const double conflict = map_->meanConflict(keyframes::firstOf(std::move(viewers), keyframes::kViewers),
                                             matched.T_map_robot, map_->keyframe(search_.keyframe).points);
  if (matched.score < map_->adapted(least_score) || conflict > 2 * options_->loop_conflict)
    return std::nullopt;
  map_->note(core::JournalEvent::kFound, matched.score, old_);
  keyframes::Hypothesis hypothesis;
  hypothesis.keyframe = search_.keyframe, hypothesis.old_keyframe = old_;
  hypothesis.T_map_robot = matched.T_map_robot;
  hypothesis.begun_m = map_->keyframe(search_.keyframe).path_m;
  return hypothesis;
}

}  // namespace slam::loops
