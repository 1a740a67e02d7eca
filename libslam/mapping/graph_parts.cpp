#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/mapping/graph_search.h"
#include "libslam/mapping/graph_slam.h"
#include "libslam/scanmatch/correlative_search.h"

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// Of the points that are searched with, at most so many: a search costs as many looks at the map for every pose.
constexpr size_t kMostQueryPoints = 80;

}  // namespace

int GraphSlam::componentOf(int k) const {
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
    if (k >= part->begin) return part->component;
  return 0;
}

bool GraphSlam::beginsPart(int k) const {
  return k > 0 &&
         std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) { return part.begin == k; });
}

void GraphSlam::beginPart(int k) {
  parts_.push_back({k, k});
  places_tried_ = 0;
}

/// The component that holds the map's origin keeps its number, 0.
void GraphSlam::joinComponents(int a, int b) {
  for (auto& part : parts_)
    if (part.component == a || part.component == b) part.component = std::min(a, b);
  places_component_ = -1;
}

/// Keyframes, kPlaceStep_m apart at least, from which all of the map that is not of this component can be looked at.
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

/// Looks whether the keyframes [query_first, query_last] around k lie at the next place of the map beyond their part.
std::optional<GraphSlam::Hypothesis> GraphSlam::findPlace(int k, int query_first, int query_last) {
  const auto& places = placesBeyond(componentOf(k));
  if (places.empty()) return std::nullopt;
  const size_t turn = places_tried_++;
  const int old = places[turn / kHeadings % places.size()];
  if (turn % kHeadings == 0)
    for (auto& hypothesis : hypotheses_) --hypothesis.places_left;
  std::vector<PatchPoint> query;
  for (int i = query_last; i >= query_first; --i) {
    if (componentOf(i) != componentOf(k)) continue;
    const Pose2 T_k_i = core::between(graph_.pose(k), graph_.pose(i));
    for (const auto& point : keyframe(i).points) query.push_back(T_k_i * point);
  }
  // Headings of the part, so that it does not matter how the robot turns meanwhile.
  const double heading = graph_.pose(k).phi + static_cast<double>(turn % kHeadings) * kHeadingStep_rad;
  const auto matched = matchAtPlace(query, old, heading);
  if (!matched) return std::nullopt;
  note("found", matched->score, old);
  Hypothesis hypothesis;
  hypothesis.keyframe = k, hypothesis.old_keyframe = old;
  hypothesis.T_map_robot = matched->T_map_robot;
  hypothesis.begun_m = path_m_;
  hypothesis.begun_at = core::position(matched->T_map_robot);
  hypothesis.places_left = static_cast<int>(places.size()) - 1;
  return hypothesis;
}

/// Keyframes of the same component around a place, the nearest first.
std::vector<int> GraphSlam::keyframesAtPlace(int place) const {
  std::vector<int> around;
  for (const int a : keyframesWithin(core::position(graph_.pose(place)), kPlaceRadius_m))
    if (componentOf(a) == componentOf(place)) around.push_back(a);
  return firstOf(std::move(around), options_.map_keyframes);
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
    if (std::hypot(point.x, point.y) <= kPlaceReach_m) near.push_back(point);
  std::vector<Point2> search_points;
  for (const auto& point : thinned(near, kQuerySpacing_m)) search_points.push_back(position(point));
  if (search_points.size() > kMostQueryPoints) {
    std::vector<Point2> fewer;
    for (size_t i = 0; i < kMostQueryPoints; ++i)
      fewer.push_back(search_points[i * search_points.size() / kMostQueryPoints]);
    search_points = std::move(fewer);
  }
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

/// A loop within a part may be closed when it is confirmed. Parts are joined where the whole map has been looked at since,
/// no other place can be followed as well, and more than a room was followed.
bool GraphSlam::mayJoin(const Hypothesis& hypothesis) const {
  const auto joins = [&](const Hypothesis& h) {
    return componentOf(h.keyframe) != componentOf(h.old_keyframe);
  };
  if (!joins(hypothesis)) return true;
  return hypothesis.places_left <= 0 && hypothesis.extent_m >= kJoinExtent_m &&
         std::count_if(hypotheses_.begin(), hypotheses_.end(), joins) == 1;
}

/// Looks for a place of the newest keyframe beyond its part; what is found is followed from then on.
void GraphSlam::lookForPart() {
  const int k = lastKeyframe();
  int first = k;
  while (first > 0 && k - first < kMostQueryKeyframes && !beginsPart(first) &&
         path_m_ - keyframe(first - 1).path_m < options_.loop_path_m)
    --first;
  if (auto found = findPlace(k, first, k)) follow(*found);
}

void GraphSlam::noteWhatStaysApart() {
  std::vector<int> said;
  for (const auto& part : parts_) {
    if (part.component == 0 || std::count(said.begin(), said.end(), part.component) > 0) continue;
    said.push_back(part.component);
    note("apart", part.begin, part.begin);
  }
}

}  // namespace slam::mapping
