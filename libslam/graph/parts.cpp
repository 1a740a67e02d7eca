#include <algorithm>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/graph/search.h"
#include "libslam/scanmatch/correlative_search.h"

namespace slam::graph {
namespace {

using core::Point2;
using scanmatch::PatchPoint;

/// Of the points that are searched with, at most so many: a search costs as many looks at the map for every
/// pose.
constexpr size_t kMostQueryPoints = 80;

}  // namespace

int GraphSlam::componentOf(int k) const {
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
    if (k >= part->begin) return part->component;
  return 0;
}

void GraphSlam::beginPart(int k) {
  parts_.push_back({k, k});
  searchAnew();
}

/// Forgets every place that was followed.
void GraphSlam::searchAnew() {
  joins_.clear(), refuted_.clear();
  places_tried_ = 0;
}

/// The component that holds the map's origin keeps its number, 0.
void GraphSlam::joinComponents(int a, int b) {
  for (auto& part : parts_)
    if (part.component == a || part.component == b) part.component = std::min(a, b);
  places_component_ = kNoComponent;
  searchAnew();
}

/// Keyframes, kPlaceStep_m apart at least, from which all of the map that is not of this component can be
/// looked at.
const std::vector<int>& GraphSlam::placesBeyond(int component) {
  const int known = graph_.nodeCount();
  // A part of its own grows with every keyframe and changes nothing beyond it.
  const bool is_old = places_component_ == component && (component > 0 || places_known_ == known);
  if (is_old) return places_;
  places_component_ = component, places_known_ = known;
  places_.clear(), pyramids_.clear();
  for (int k = 0; k < known; ++k) {
    if (componentOf(k) == component) continue;
    const bool is_near = std::any_of(places_.begin(), places_.end(), [&](int place) {
      return core::distance(graph_.pose(place), graph_.pose(k)) < kPlaceStep_m;
    });
    if (!is_near) places_.push_back(k);
  }
  return places_;
}

/// Keyframes of the same component around a place, the nearest first.
std::vector<int> GraphSlam::keyframesAtPlace(int place) const {
  std::vector<int> around;
  for (const int a : keyframesWithin(core::position(graph_.pose(place)), kPlaceRadius_m))
    if (componentOf(a) == componentOf(place)) around.push_back(a);
  return firstOf(std::move(around), options_.map_keyframes);
}

/// The nearest keyframes of a component.
std::vector<int> GraphSlam::keyframesNear(const Point2& centre, int component, int most) const {
  std::vector<int> near;
  for (const int k : keyframesWithin(centre, options_.map_radius_m)) {
    if (componentOf(k) == component) near.push_back(k);
    if (static_cast<int>(near.size()) == most) break;
  }
  return near;
}

const scanmatch::LikelihoodPyramid& GraphSlam::pyramidOf(int place) {
  const auto known = pyramids_.find(place);
  if (known != pyramids_.end()) return known->second;
  std::vector<PatchPoint> points;
  for (const int a : keyframesAtPlace(place))
    for (const auto& point : keyframe(a).points) points.push_back(graph_.pose(a) * point);
  std::vector<Point2> positions;
  for (const auto& point : thinned(points, kSearchCell_m)) positions.push_back(position(point));
  return pyramids_
      .emplace(place, scanmatch::LikelihoodPyramid(positions, kSearchCell_m, kSearchSigma_m, kSearchLevels))
      .first->second;
}

/// Where points fit best around a keyframe, near a heading, if they fit at all.
std::optional<scanmatch::MatchResult> GraphSlam::matchAtPlace(const std::vector<PatchPoint>& query, int place,
                                                              double heading_rad) {
  const Point2 centre = core::position(graph_.pose(place));
  const auto around = keyframesAtPlace(place);
  std::vector<PatchPoint> near;
  for (const auto& point : query)
    if (core::hypot(point.x, point.y) <= kPlaceReach_m) near.push_back(point);
  const auto search_points = searchPoints(near, kMostQueryPoints);
  const auto found = searchBest(pyramidOf(place), search_points, {centre.x, centre.y, heading_rad},
                                {kPlaceHalf_m, 0.5 * kHeadingStep_rad}, options_.loop_score);
  if (!found) return std::nullopt;
  const auto points = thinned(near, kQueryMatchSpacing_m);
  const auto matched = matchFreely(points, around, found->T_map_robot);
  std::vector<int> viewers;
  for (const int a : around)
    if (core::distance(graph_.pose(a), matched.T_map_robot) <= kViewerDistance_m) viewers.push_back(a);
  const double conflict = meanConflict(firstOf(std::move(viewers), kViewers), matched.T_map_robot, points);
  if (matched.score < options_.loop_score || conflict > 2 * options_.loop_conflict) return std::nullopt;
  return matched;
}

void GraphSlam::noteWhatStaysApart() {
  std::vector<int> said;
  for (const auto& part : parts_) {
    if (part.component == 0 || std::count(said.begin(), said.end(), part.component) > 0) continue;
    said.push_back(part.component);
    note(core::JournalEvent::kApart, part.begin, part.begin);
  }
}

}  // namespace slam::graph
