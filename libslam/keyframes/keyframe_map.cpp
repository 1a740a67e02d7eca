#include "libslam/keyframes/keyframe_map.h"

#include <algorithm>
#include <utility>

#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::keyframes {

using core::Point2;
using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

namespace {

/// Keyframes whose points stay sorted: those of a map and of a pass or two beside it.
constexpr size_t kSorted = 64;

}  // namespace

LevelMaps::LevelMaps(const GraphOptions& o, bool for_tracking)
    : fine(o.cell_m, o.blur_m, for_tracking, for_tracking),
      middle(2 * o.cell_m, o.blur_m + 0.02, false, for_tracking),
      coarse(4 * o.cell_m, o.blur_m + 0.07, false, for_tracking) {}

KeyframeMap::KeyframeMap(const GraphOptions& options)
    : options_(options), scratch_(options, false), sorted_(kSorted) {
  // Memory that is touched for the first time is slow: no scan shall wait for it.
  fill(scratch_, {}, {});
}

void KeyframeMap::note(core::JournalEvent event, double value, int other_keyframe,
                       const std::string& detail) {
  journal_.push_back({scan_, event, value, other_keyframe < 0 ? -1 : keyframe(other_keyframe).scan, detail});
}

void KeyframeMap::addLoop(const std::vector<posegraph::Edge>& edges) {
  loop_begins_.push_back(static_cast<int>(graph_.edges().size()));
  for (const auto& edge : edges) graph_.addEdge(edge);
}

void KeyframeMap::removeClosure(int a, int b) {
  closures_.erase(std::remove(closures_.begin(), closures_.end(), std::pair(a, b)), closures_.end());
}

void KeyframeMap::noteExplained(double share) {
  constexpr double kMostCounted = 1000;
  explained_count_ = std::min(explained_count_ + 1, kMostCounted);
  explained_ += (share - explained_) / explained_count_;
}

double KeyframeMap::adapted(double score) const {
  // Dense logs have 0.84 to 0.87. With 0.8 here a wrong loop was closed outdoors, in one of 23 settings.
  constexpr double kUsual = 0.7;
  return score * std::min(explained_ / kUsual, 1.0);
}

void KeyframeMap::link(int a, int b) {
  links_.join(a, b, core::distance(graph_.pose(a), graph_.pose(b)));
}

MatchResult KeyframeMap::matchFreely(const std::vector<PatchPoint>& points, const std::vector<int>& keyframes,
                                     const Pose2& T_start, bool with_coarse) const {
  const LevelMaps& maps = mapOf(keyframes, core::position(T_start));
  PosePrior flat;
  flat.mean = T_start;
  flat.information.setIdentity();
  return match(points, maps, T_start, flat, 0, with_coarse);
}

const LevelMaps& KeyframeMap::mapOf(const std::vector<int>& keyframes, const Point2& centre) const {
  fill(scratch_, keyframes, centre);
  return scratch_;
}

const scanmatch::ScanInCells& KeyframeMap::inCells(int k) const {
  const Pose2& T = graph_.pose(k);
  auto kept =
      std::find_if(sorted_.begin(), sorted_.end(), [k](const Sorted& one) { return one.keyframe == k; });
  if (kept == sorted_.end())
    kept = std::min_element(sorted_.begin(), sorted_.end(),
                            [](const Sorted& a, const Sorted& b) { return a.asked < b.asked; });
  kept->asked = ++asked_;
  if (kept->keyframe != k || kept->revision != revision_ || !(kept->T_map_robot == T)) {
    kept->keyframe = k, kept->revision = revision_, kept->T_map_robot = T;
    kept->scan.sort(keyframe(k).points, T, options_.cell_m);
  }
  return kept->scan;
}

void KeyframeMap::fill(LevelMaps& maps, const std::vector<int>& keyframes, const Point2& centre) const {
  for (auto* map : {&maps.fine, &maps.middle, &maps.coarse}) map->clear(centre, kMapReach_m);
  for (const int k : keyframes) maps.fine.add(inCells(k), k);
  maps.middle.add(maps.fine);
  maps.coarse.add(maps.middle);
}

std::vector<int> KeyframeMap::keyframesAround(int start, const Point2& centre, double path_m,
                                              double radius_m) const {
  std::vector<int> result;
  for (const auto& [away2, k] : links_.around(graph_.poses(), start, centre, path_m, radius_m))
    if (mayBeMatchedTo(k)) result.push_back(k);
  return result;
}

std::vector<int> KeyframeMap::keyframesLookingAlike(int start, const Pose2& T_map_robot, double path_m,
                                                    double radius_m, int most) const {
  const Point2 here = core::position(T_map_robot), seen = T_map_robot * keyframe(start).view_centre;
  std::vector<std::pair<double, int>> found;
  for (const auto& [away2, k] : links_.around(graph_.poses(), start, here, path_m, radius_m)) {
    if (!mayBeMatchedTo(k)) continue;
    const double off_m = core::distance(graph_.pose(k) * keyframe(k).view_centre, seen);
    found.emplace_back(away2 + off_m * off_m, k);
  }
  const auto count = std::min(found.size(), static_cast<size_t>(most));
  std::partial_sort(found.begin(), found.begin() + static_cast<std::ptrdiff_t>(count), found.end());
  std::vector<int> result;
  result.reserve(count);
  for (size_t i = 0; i < count; ++i) result.push_back(found[i].second);
  return result;
}

std::vector<int> KeyframeMap::keyframesLinkedWith(int start, double path_m) const {
  std::vector<int> result = links_.linkedWith(start, path_m);
  result.erase(std::remove_if(result.begin(), result.end(), [&](int k) { return !mayBeMatchedTo(k); }),
               result.end());
  return result;
}

std::vector<int> KeyframeMap::keyframesWithin(const Point2& centre, double radius_m) const {
  std::vector<std::pair<double, int>> near;
  for (int k = 0; k < graph_.nodeCount(); ++k) {
    const double away_m = core::distance(core::position(graph_.pose(k)), centre);
    if (away_m <= radius_m && mayBeMatchedTo(k)) near.push_back({away_m, k});
  }
  std::sort(near.begin(), near.end());
  std::vector<int> keyframes;
  keyframes.reserve(near.size());
  for (const auto& item : near) keyframes.push_back(item.second);
  return keyframes;
}

std::vector<double> KeyframeMap::pathTo(int k) const {
  std::vector<double> path_m;
  path_m.reserve(keyframes_.size());
  for (const auto& one : keyframes_) path_m.push_back(one.path_m);
  return shortestWays(path_m, closures_, k);
}

int KeyframeMap::gapsBetween(int a, int b) const {
  return static_cast<int>(std::count_if(parts_.begin(), parts_.end(),
                                        [&](const Part& part) { return part.begin > a && part.begin <= b; }));
}

std::vector<Point2> KeyframeMap::placeAround(const std::vector<int>& keyframes) const {
  std::vector<Point2> place;
  for (const int k : keyframes)
    for (const auto& point : keyframe(k).points) place.push_back(graph_.pose(k) * position(point));
  return place;
}

void KeyframeMap::addLoopEdges(std::vector<posegraph::Edge>& edges, const std::vector<int>& around, int k,
                               const Pose2& T_map_robot, const scanmatch::SurfelMap& map) const {
  const Eigen::Matrix3d information = toldInformation(keyframe(k).points, map, T_map_robot);
  const size_t partners = std::min<size_t>(around.size(), kConfirmEdges);
  for (size_t i = 0; i < partners; ++i) {
    posegraph::Edge edge;
    edge.from = around[i], edge.to = k;
    edge.T_from_to = core::between(graph_.pose(around[i]), T_map_robot);
    edge.information =
        scanmatch::edgeInformation(information, T_map_robot.phi) / static_cast<double>(kConfirmEdges);
    edge.kind = posegraph::EdgeKind::kLoop;
    edges.push_back(edge);
  }
}

void KeyframeMap::tie(int k, const std::vector<int>& partners, const Pose2& T_map_robot,
                      const Eigen::Matrix3d& information, double share) {
  for (const int partner : partners) {
    posegraph::Edge edge;
    edge.from = partner, edge.to = k;
    edge.T_from_to = core::between(graph_.pose(partner), T_map_robot);
    edge.information = scanmatch::edgeInformation(information, T_map_robot.phi) / share;
    graph_.addEdge(edge);
    link(partner, k);
  }
}

int KeyframeMap::componentOf(int k) const {
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
    if (k >= part->begin) return part->component;
  return 0;
}

void KeyframeMap::joinComponents(int a, int b) {
  for (auto& part : parts_)
    if (part.component == a || part.component == b) part.component = std::min(a, b);
}

std::vector<int> KeyframeMap::keyframesAtPlace(int place) const {
  std::vector<int> around;
  for (const int a : keyframesWithin(core::position(graph_.pose(place)), kPlaceRadius_m))
    if (componentOf(a) == componentOf(place)) around.push_back(a);
  return firstOf(std::move(around), options_.map_keyframes);
}

std::vector<int> KeyframeMap::keyframesNear(const Point2& centre, int component, int most) const {
  std::vector<int> near;
  for (const int k : keyframesWithin(centre, options_.map_radius_m)) {
    if (componentOf(k) == component) near.push_back(k);
    if (static_cast<int>(near.size()) == most) break;
  }
  return near;
}

int KeyframeMap::keyframeBefore(int k) const {
  const int edge = keyframe(k).odometry_edge;
  return edge < 0 ? -1 : graph_.edges()[static_cast<size_t>(edge)].from;
}

}  // namespace slam::keyframes
