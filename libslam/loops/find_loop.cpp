#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/loops/loop_closer.h"
#include "libslam/scanmatch/correlative_search.h"

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

/// Half of the points lie within this distance of the robot.
double viewRadius(const std::vector<Point2>& points) {
  std::vector<double> distances;
  distances.reserve(points.size());
  for (const auto& p : points) distances.push_back(core::hypot(p.x, p.y));
  return core::middleValue(std::move(distances));
}

}  // namespace

/// From keyframe k, how far it is to each of the old ones.
keyframes::LoopSearch LoopCloser::loopSearch(int k) const {
  keyframes::LoopSearch search;
  search.keyframe = k;
  search.way_m = map_->pathTo(k);
  const int component = map_->componentOf(k);
  for (int old = 0; old < k; ++old)
    if (map_->componentOf(old) != component)
      search.way_m[static_cast<size_t>(old)] = map_->keyframe(k).path_m - map_->keyframe(old).path_m -
                                               map_->gapsBetween(old, k) * keyframes::kGapPath_m;
  search.is_local.assign(map_->keyframes().size(), 0);
  for (const int local : map_->keyframesAround(k, core::position(map_->pose(k)), options_->map_path_m, 1e9))
    search.is_local[static_cast<size_t>(local)] = 1;
  return search;
}

/// With the scans of the keyframes [first, last] around it.
void LoopCloser::gatherQuery(keyframes::LoopSearch& search, int first, int last) const {
  std::vector<PatchPoint> query;
  for (int i = last; i >= first; --i) {
    const Pose2 T_k_i = core::between(map_->pose(search.keyframe), map_->pose(i));
    for (const auto& point : map_->keyframe(i).points) query.push_back(T_k_i * point);
  }
  search.points = keyframes::searchPoints(query, kMostQueryPoints);
  search.match_points = keyframes::thinned(query, keyframes::kQueryMatchSpacing_m);
  search.view_m = viewRadius(search.points);
}

double LoopCloser::loopReach(const keyframes::LoopSearch& search, int old) const {
  const double least_m =
      map_->componentOf(old) == map_->componentOf(search.keyframe) ? options_->loop_reach_m : kNoGap_m;
  return std::min(least_m + options_->loop_reach_per_m * search.way_m[static_cast<size_t>(old)],
                  options_->loop_reach_most_m);
}

/// Old keyframes that drift could have carried apart from it, the nearest first.
std::vector<int> LoopCloser::loopCandidates(const keyframes::LoopSearch& search) const {
  const int k = search.keyframe;
  std::vector<std::pair<double, int>> by_distance;
  for (int old = 0; old < k; ++old) {
    if (search.is_local[static_cast<size_t>(old)] || !map_->mayBeMatchedTo(old)) continue;
    const double away_m = core::distance(map_->pose(old), map_->pose(k));
    if (away_m < loopReach(search, old) + 1) by_distance.push_back({away_m, old});
  }
  std::sort(by_distance.begin(), by_distance.end());
  std::vector<int> candidates;
  candidates.reserve(by_distance.size());
  for (const auto& [away_m, old] : by_distance) candidates.push_back(old);
  return candidates;
}

/// Looks for a place where the scans of the keyframes [query_first, query_last] around k were seen before:
/// the best one, and after it the best elsewhere in its window that explains nearly as much.
std::vector<keyframes::Hypothesis> LoopCloser::findLoop(int k, int query_first, int query_last) {
  keyframes::LoopSearch search = loopSearch(k);
  const auto candidates = loopCandidates(search);
  if (candidates.empty()) return {};
  gatherQuery(search, query_first, query_last);
  searched_reach_m_ = 0;
  std::vector<char> is_tried(map_->keyframes().size(), 0);
  int places = 0;
  for (const int old : candidates) {
    if (is_tried[static_cast<size_t>(old)]) continue;
    if (++places > kMostPlaces) break;
    for (const int tried :
         map_->keyframesAround(old, core::position(map_->pose(old)), options_->map_path_m, 1e9))
      is_tried[static_cast<size_t>(tried)] = 1;
    if (auto found = loopsAt(search, old); !found.empty()) return found;
  }
  return {};
}

/// The same around one old keyframe.
std::vector<keyframes::Hypothesis> LoopCloser::loopsAt(const keyframes::LoopSearch& search, int old) {
  auto around = map_->keyframesAround(old, core::position(map_->pose(old)), keyframes::kPlacePath_m,
                                      keyframes::kPlaceRadius_m);
  around.erase(std::remove_if(around.begin(), around.end(),
                              [&](int a) { return search.is_local[static_cast<size_t>(a)] != 0; }),
               around.end());
  around = keyframes::firstOf(std::move(around), options_->map_keyframes);
  // A wide window is searched on a coarser raster: it costs as its cube. So is a wide view: the angle
  // between two beams leaves it no finer detail, and every turn that it tells apart costs.
  const double reach_m = loopReach(search, old);
  const double coarser =
      std::clamp(std::max(reach_m / kFineReach_m, search.view_m / kFineView_m), 1.0, kCoarsest);
  pyramid_.build(map_->placeAround(around), coarser * keyframes::kSearchCell_m,
                 coarser * keyframes::kSearchSigma_m, keyframes::kSearchLevels);
  scanmatch::SearchWindow window{
      reach_m, std::min(kSearchTurn_rad + kSearchTurnPerMetre_rad * search.way_m[static_cast<size_t>(old)],
                        kSearchTurnMost_rad)};
  searched_reach_m_ = std::max(searched_reach_m_, window.half_xy_m);
  std::vector<keyframes::Hypothesis> loops;
  const Pose2& here = map_->pose(search.keyframe);
  const auto best = searchBest(pyramid_, search.points, here, window, options_->loop_search_score);
  if (!best) return loops;
  map_->note(core::JournalEvent::kSearched, best->score, old);
  // What is followed needs no match of all that is searched for: each keyframe is matched by itself.
  const auto add = [&](const Pose2& T_found, double least_score) {
    if (isFollowing(search.keyframe, T_found)) return true;
    const auto loop = loopFrom(search, old, around, T_found, coarser > 1, least_score);
    if (loop) loops.push_back(*loop);
    return loop.has_value();
  };
  if (!add(best->T_map_robot, options_->loop_score)) return loops;
  window.apart_m = kRivalApart_m, window.not_at = core::position(best->T_map_robot);
  const double off_m = core::distance(best->T_map_robot, here);
  const auto rival = searchBest(pyramid_, search.points, here, window, kRivalShare * best->score);
  if (!rival) return loops;
  add(rival->T_map_robot, 0);
  // One that the way there makes likelier may be at the edge of the map, where less is explained.
  window.half_xy_m = std::min(off_m - kRivalApart_m, kLikelyReach_m);
  if (window.half_xy_m <= 0 || core::distance(rival->T_map_robot, here) < window.half_xy_m) return loops;
  if (const auto likelier = searchBest(pyramid_, search.points, here, window, kRivalShare * best->score))
    add(likelier->T_map_robot, 0);
  return loops;
}

/// A place that was found around an old keyframe, if its map, matched, explains what is searched for.
std::optional<keyframes::Hypothesis> LoopCloser::loopFrom(const keyframes::LoopSearch& search, int old,
                                                          const std::vector<int>& around,
                                                          const Pose2& T_found, bool is_coarse,
                                                          double least_score) {
  const auto matched = map_->matchFreely(search.match_points, around, T_found, is_coarse);
  std::vector<int> viewers;
  for (const int a : around)
    if (core::distance(map_->pose(a), matched.T_map_robot) <= keyframes::kViewerDistance_m)
      viewers.push_back(a);
  const double conflict = map_->meanConflict(keyframes::firstOf(std::move(viewers), keyframes::kViewers),
                                             matched.T_map_robot, map_->keyframe(search.keyframe).points);
  if (matched.score < least_score || conflict > 2 * options_->loop_conflict) return std::nullopt;
  map_->note(core::JournalEvent::kFound, matched.score, old);
  keyframes::Hypothesis hypothesis;
  hypothesis.keyframe = search.keyframe, hypothesis.old_keyframe = old;
  hypothesis.T_map_robot = matched.T_map_robot;
  hypothesis.begun_m = map_->path_m();
  return hypothesis;
}

}  // namespace slam::loops
