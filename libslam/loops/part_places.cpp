#include <algorithm>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/part_finder.h"
#include "libslam/scanmatch/correlative_search.h"

namespace slam::loops {
namespace {

using core::Point2;
using scanmatch::PatchPoint;

/// Of the points that are searched with, at most so many: a search costs as many looks at the map for every
/// pose.
constexpr size_t kMostQueryPoints = 80;

}  // namespace

void PartFinder::searchAnew() {
  joins_.clear(), itself_.clear();
  places_tried_ = 0;
}

void PartFinder::forgetPlaces() {
  places_component_ = kNoComponent;
  searchAnew();
}

/// Keyframes, kPlaceStep_m apart at least, from which all of the map that is not of this component can be
/// looked at.
const std::vector<int>& PartFinder::placesBeyond(int component) {
  const int known = map_->size();
  // A part of its own grows with every keyframe and changes nothing beyond it.
  const bool is_old = places_component_ == component && (component > 0 || places_known_ == known);
  if (is_old) return places_;
  places_component_ = component, places_known_ = known;
  places_.clear(), pyramids_.clear();
  for (int k = 0; k < known; ++k) {
    if (map_->componentOf(k) == component) continue;
    const bool is_near = std::any_of(places_.begin(), places_.end(), [&](int place) {
      return core::distance(map_->pose(place), map_->pose(k)) < keyframes::kPlaceStep_m;
    });
    if (!is_near) places_.push_back(k);
  }
  return places_;
}

const scanmatch::LikelihoodPyramid& PartFinder::pyramidOf(int place) {
  const auto known = pyramids_.find(place);
  if (known != pyramids_.end()) return known->second;
  std::vector<PatchPoint> points;
  for (const int a : map_->keyframesAtPlace(place))
    for (const auto& point : map_->keyframe(a).points) points.push_back(map_->pose(a) * point);
  std::vector<Point2> positions;
  for (const auto& point : keyframes::thinned(points, keyframes::kSearchCell_m))
    positions.push_back(position(point));
  return pyramids_
      .emplace(place, scanmatch::LikelihoodPyramid(positions, keyframes::kSearchCell_m,
                                                   keyframes::kSearchSigma_m, keyframes::kSearchLevels))
      .first->second;
}

/// Where points fit best around a keyframe, near a heading, if they fit at all.
std::optional<scanmatch::MatchResult> PartFinder::matchAtPlace(const std::vector<PatchPoint>& query,
                                                               int place, double heading_rad) {
  const Point2 centre = core::position(map_->pose(place));
  const auto around = map_->keyframesAtPlace(place);
  std::vector<PatchPoint> near;
  for (const auto& point : query)
    if (core::hypot(point.x, point.y) <= keyframes::kPlaceReach_m) near.push_back(point);
  const auto search_points = keyframes::searchPoints(near, kMostQueryPoints);
  const auto found =
      searchBest(pyramidOf(place), search_points, {centre.x, centre.y, heading_rad},
                 {keyframes::kPlaceHalf_m, 0.5 * keyframes::kHeadingStep_rad}, options_->loop_score);
  if (!found) return std::nullopt;
  const auto points = keyframes::thinned(near, keyframes::kQueryMatchSpacing_m);
  const auto matched = map_->matchFreely(points, around, found->T_map_robot);
  std::vector<int> viewers;
  for (const int a : around)
    if (core::distance(map_->pose(a), matched.T_map_robot) <= keyframes::kViewerDistance_m)
      viewers.push_back(a);
  const double conflict = map_->meanConflict(keyframes::firstOf(std::move(viewers), keyframes::kViewers),
                                             matched.T_map_robot, points);
  if (matched.score < options_->loop_score || conflict > 2 * options_->loop_conflict) return std::nullopt;
  return matched;
}

}  // namespace slam::loops
