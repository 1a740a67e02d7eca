#include <algorithm>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"

namespace slam::graph {
namespace {

using core::Pose2;

/// Parts lie so far apart until they are joined that nothing sees from one into another.
constexpr double kApart_m = 1000;
/// How a keyframe lies to those around it in a map of before.
constexpr double kKnown_m = 0.02, kKnown_rad = 0.005;
/// Every so many keyframes are held against the other parts in the end.
constexpr int kJudgedStep = 2;

}  // namespace

void GraphSlam::addKnownKeyframe(const lidar::Scan& scan, const Pose2& T_given_robot) {
  if (!records_.empty()) throw core::ContractError("GraphSlam: known keyframes come before the first scan");
  const int k = map_->size();
  const bool begins_part = k > 0 && map_->parts().back().begin == k;
  const Pose2 T_map_robot =
      known_parts_.empty() ? T_given_robot : known_parts_.back().T_map_given * T_given_robot;
  if (begins_part) {
    known_parts_.back().T_given_first = T_given_robot;
    around().setKeyframes({});
    map_->drive(keyframes::kGapPath_m);
  } else {
    T_keyframe_hung_ = T_odometry_ = core::between(k == 0 ? Pose2{} : map_->pose(k - 1), T_map_robot);
    map_->drive(core::hypot(T_odometry_.x, T_odometry_.y));
  }
  const bool loops = std::exchange(options_.loops, false);
  addKeyframe(scan, keyframes::pointsOf(scan, options_), T_map_robot,
              scanmatch::poseInformation(kKnown_m, kKnown_rad));
  if (begins_part) loosen(k);
  map_->keyframes().back().scan = keyframes::kOfEarlierRun;
  options_.loops = loops;
}

void GraphSlam::beginKnownPart() {
  if (map_->keyframes().empty()) throw core::ContractError("GraphSlam: a part of no map");
  double right_m = 0;
  for (const auto& pose : map_->graph().poses()) right_m = std::max(right_m, pose.x);
  known_parts_.push_back({{right_m + kApart_m, 0, 0}, {}});
  beginPart(map_->size());
  explained_here_ = 0;
}

int GraphSlam::endOfPart(size_t part) const {
  return part + 1 < map_->parts().size() ? map_->parts()[part + 1].begin : map_->size();
}

std::vector<loops::PartPlace> GraphSlam::joinParts(core::Progress& progress) {
  if (!options_.loops) throw core::ContractError("GraphSlam: parts are not joined without loops");
  if (map_->parts().back().begin == map_->size())
    throw core::ContractError("GraphSlam: a part without a keyframe");
  std::vector<loops::PartPlace> places(known_parts_.size());
  // What finds no place in one part may find it in another that was joined since.
  for (bool goes_on = true; goes_on;) {
    goes_on = false;
    for (size_t p = 1; p < map_->parts().size(); ++p) {
      if (map_->componentOf(map_->parts()[p].begin) == 0) continue;
      const auto found = finder_.placeOfPart(map_->parts()[p].begin, endOfPart(p), progress);
      const auto accepted = found ? loops_.accept(found->loop) : std::nullopt;
      if (!accepted) continue;
      noteLoop(*accepted);
      completeClosing();
      places[p - 1] = found->place;
      goes_on = true;
    }
  }
  loops_.searchRemainingLoops(
      0, [this] { haveMoved(); }, progress);
  if (options_.refine_rounds > 0) refine(progress);
  putApart();
  for (size_t p = 1; p < map_->parts().size(); ++p) judge(p, places[p - 1]);
  return places;
}

/// Parts without a known place lie where they were given: poses that were found anew, for a loop elsewhere,
/// have followed the weak edge to the part before.
void GraphSlam::putApart() {
  for (size_t p = 1; p < map_->parts().size(); ++p) {
    const auto [first, component] = map_->parts()[p];
    if (component != first) continue;  // joined to an earlier one
    const Pose2 given = known_parts_[p - 1].T_map_given * known_parts_[p - 1].T_given_first,
                T_apart_map = given * core::inverse(map_->pose(first));
    for (int k = first; k < map_->size(); ++k)
      if (map_->componentOf(k) == component) map_->graph().setPose(k, T_apart_map * map_->pose(k));
  }
}

/// What the keyframes of a part and those of the others say of each other, as they lie in the end.
void GraphSlam::judge(size_t part, loops::PartPlace& place) const {
  const int first = map_->parts()[part].begin, end = endOfPart(part);
  place.is_joined = map_->componentOf(first) == 0;
  place.T_map_part = map_->pose(first) * core::inverse(known_parts_[part - 1].T_given_first);
  int judged = 0, sharing = 0;
  double told = 0, against = 0;
  for (int k = first; k < end; k += kJudgedStep) {
    ++judged;
    std::vector<int> viewers;
    for (const int other : map_->keyframesWithin(core::position(map_->pose(k)), options_.map_radius_m))
      if ((other < first || other >= end) && static_cast<int>(viewers.size()) < keyframes::kAskedViewers)
        viewers.push_back(other);
    const keyframes::Told said =
        map_->toldBy(viewers, map_->keyframe(k).points, map_->pose(k), &map_->keyframe(k).seen);
    if (said.telling < keyframes::kToldToJoin) continue;
    ++sharing;
    told += said.telling;
    against += said.telling * said.contradicted;
  }
  place.shared = static_cast<double>(sharing) / judged;
  place.contradicted = told > 0 ? against / told : 0;
}

}  // namespace slam::graph
