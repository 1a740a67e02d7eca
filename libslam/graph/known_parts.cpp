#include <algorithm>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/graph/search.h"

namespace slam::graph {
namespace {

using core::Pose2;

/// Of a keyframe that was known before: journal entries refer to no scan then.
constexpr int kOfEarlierRun = -1;
/// Parts lie so far apart until they are joined that nothing sees from one into another.
constexpr double kApart_m = 1000;
/// How a keyframe lies to those around it in a map of before.
constexpr double kKnown_m = 0.02, kKnown_rad = 0.005;
/// Places along a part from which it is searched for, in keyframes: half of the trail that is followed.
constexpr int kTrailStep = 20;
/// Every so many keyframes are held against the other parts in the end.
constexpr int kJudgedStep = 2;
/// A keyframe of which another part says less says nothing.
constexpr double kTold = 0.3;

}  // namespace

void GraphSlam::addKnownKeyframe(const robot::Scan& scan, const Pose2& T_given_robot) {
  if (!records_.empty()) throw core::ContractError("GraphSlam: known keyframes come before the first scan");
  const int k = graph_.nodeCount();
  const bool begins_part = k > 0 && parts_.back().begin == k;
  const Pose2 T_map_robot =
      known_parts_.empty() ? T_given_robot : known_parts_.back().T_map_given * T_given_robot;
  if (begins_part) {
    known_parts_.back().T_given_first = T_given_robot;
    map_keyframes_.clear();
    path_m_ += kApart_m;
  } else {
    T_odometry_ = core::between(k == 0 ? Pose2{} : graph_.pose(k - 1), T_map_robot);
    path_m_ += core::hypot(T_odometry_.x, T_odometry_.y);
  }
  const bool loops = std::exchange(options_.loops, false);
  addKeyframe(scan, pointsOf(scan), T_map_robot, scanmatch::poseInformation(kKnown_m, kKnown_rad));
  if (begins_part) loosen(k);
  keyframes_.back().scan = kOfEarlierRun;
  options_.loops = loops;
}

void GraphSlam::beginKnownPart() {
  if (keyframes_.empty()) throw core::ContractError("GraphSlam: a part of no map");
  double right_m = 0;
  for (const auto& pose : graph_.poses()) right_m = std::max(right_m, pose.x);
  known_parts_.push_back({{right_m + kApart_m, 0, 0}, {}});
  beginPart(graph_.nodeCount());
}

int GraphSlam::endOfPart(size_t part) const {
  return part + 1 < parts_.size() ? parts_[part + 1].begin : graph_.nodeCount();
}

std::vector<PartPlace> GraphSlam::joinParts(core::Progress& progress) {
  if (!options_.loops) throw core::ContractError("GraphSlam: parts are not joined without loops");
  std::vector<PartPlace> places(known_parts_.size());
  // What finds no place in one part may find it in another that was joined since.
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (size_t p = 1; p < parts_.size(); ++p) {
      if (componentOf(parts_[p].begin) == 0) continue;
      const auto found = placeOfPart(parts_[p].begin, endOfPart(p), progress);
      if (!found) continue;
      places[p - 1] = *found;
      goes_on = true;
    }
  }
  searchRemainingLoops();
  if (options_.refine_rounds > 0) refine();
  for (size_t p = 1; p < parts_.size(); ++p) judge(p, places[p - 1]);
  return places;
}

/// Looks for the keyframes [first, end) from some of them, one after the other, in all of the map that is not
/// joined to them; and joins them there.
std::optional<PartPlace> GraphSlam::placeOfPart(int first, int end, core::Progress& progress) {
  const int component = componentOf(first);
  const size_t all = kHeadings * placesBeyond(component).size();
  // The last place may be one that the rest of the map does not know.
  for (int last = std::min(first + 2 * kTrailStep, end) - 1;; last = std::min(last + kTrailStep, end - 1)) {
    searchAnew();
    join_first_ = first, join_last_ = last;
    for (size_t n = 0; n < 4 * all; ++n) {
      progress.update(static_cast<double>(last - first) / (end - first), 0);
      const Join* join = workOnJoins(component);
      if (join == nullptr) {
        if (joins_.empty() && n >= all) break;
        continue;
      }
      PartPlace place;
      place.fitting = join->fitting;
      place.extent_m = join->fits.diagonal_m();
      place.ahead_nats = 0;
      for (const auto& said : join->says) place.ahead_nats += said.second.nats;
      for (const auto& other : joins_)
        if (&other != join) place.ahead_nats = std::min(place.ahead_nats, aheadOf(*join, other));
      joinPart(*join);
      if (componentOf(first) != component) return place;
      break;
    }
    if (last == end - 1) return std::nullopt;
  }
}

/// What the keyframes of a part and those of the others say of each other, as they lie in the end.
void GraphSlam::judge(size_t part, PartPlace& place) const {
  const int first = parts_[part].begin, end = endOfPart(part);
  place.is_joined = componentOf(first) == 0;
  place.T_map_part = graph_.pose(first) * core::inverse(known_parts_[part - 1].T_given_first);
  int judged = 0, sharing = 0;
  double told = 0, against = 0;
  for (int k = first; k < end; k += kJudgedStep) {
    ++judged;
    std::vector<int> viewers;
    for (const int other : keyframesWithin(core::position(graph_.pose(k)), options_.map_radius_m))
      if ((other < first || other >= end) && static_cast<int>(viewers.size()) < kAskedViewers)
        viewers.push_back(other);
    const Told said = toldBy(viewers, keyframe(k).points, graph_.pose(k), &keyframe(k).seen);
    if (said.telling < kTold) continue;
    ++sharing;
    told += said.telling;
    against += said.telling * said.contradicted;
  }
  place.shared = static_cast<double>(sharing) / judged;
  place.contradicted = told > 0 ? against / told : 0;
}

}  // namespace slam::graph
