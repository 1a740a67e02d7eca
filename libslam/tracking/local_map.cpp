#include "libslam/tracking/local_map.h"

#include <algorithm>
#include <utility>

#include "libslam/core/rigid_motion2.h"
#include "libslam/keyframes/matching.h"

namespace slam::tracking {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;

}  // namespace

LocalMap::LocalMap(const keyframes::KeyframeMap& map)
    : map_(&map), options_(&map.options()), maps_(map.options(), true) {
  map_->fill(maps_, {}, {});
}

void LocalMap::fillAround(int keyframe, const Pose2& T_map_robot) {
  keyframes_ = map_->keyframesLookingAlike(keyframe, T_map_robot, options_->map_path_m,
                                           options_->map_radius_m, options_->map_keyframes);
  map_->fill(maps_, keyframes_, core::position(T_map_robot));
}

void LocalMap::fillNear(const Point2& centre) {
  keyframes_ =
      keyframes::firstOf(map_->keyframesWithin(centre, options_->map_radius_m), options_->map_keyframes);
  map_->fill(maps_, keyframes_, centre);
}

double LocalMap::toldScore(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  constexpr double kLeastTold = 0.2;
  const auto viewers = keyframes::firstOf(keyframes_, keyframes::kAskedViewers);
  const Point2 origin = maps_.fine.origin();
  const auto beams = map_->beamsOf(viewers);
  const core::RigidMotion2 T_map_points(T_map_robot);
  std::vector<PatchPoint> told;
  for (const auto& point : points) {
    const Point2 p_map = T_map_points * position(point);
    bool is_told = maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
    for (size_t i = 0; !is_told && i < beams.size(); ++i)
      is_told = beams[i].say(p_map) == keyframes::Sight::kPassed;
    if (is_told) told.push_back(point);
  }
  const double share = surfelScore(told, maps_.fine, T_map_robot, keyframes::kKernel, 1);
  const double least = kLeastTold * static_cast<double>(points.size());
  return share * std::min(1.0, static_cast<double>(told.size()) / std::max(least, 1.0));
}

double LocalMap::gain(const std::vector<PatchPoint>& points, const Pose2& T_map_robot,
                      const Pose2& T_map_other) const {
  const auto viewers = keyframes::firstOf(keyframes_, keyframes::kAskedViewers);
  const Point2 origin = maps_.fine.origin();
  const auto beams = map_->beamsOf(viewers);
  const core::RigidMotion2 T_here(T_map_robot), T_there(T_map_other);
  const auto says = [&](const core::RigidMotion2& T, const PatchPoint& point) {
    const Point2 p_map = T * position(point);
    bool agreed = false;
    for (const auto& viewer : beams) {
      const keyframes::Sight seen = viewer.say(p_map);
      if (seen == keyframes::Sight::kPassed) return true;
      agreed = agreed || seen == keyframes::Sight::kAgreed;
    }
    return agreed && maps_.fine.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  };
  std::vector<PatchPoint> telling;
  for (size_t p = 0; p < points.size(); p += keyframes::kStride)
    if (says(T_here, points[p]) && says(T_there, points[p])) telling.push_back(points[p]);
  return surfelScore(telling, maps_.fine, T_map_robot, keyframes::kKernel, 1) -
         surfelScore(telling, maps_.fine, T_map_other, keyframes::kKernel, 1);
}

bool LocalMap::isPoor(const MatchResult& result, const std::vector<PatchPoint>& points) const {
  return result.score < options_->recover_score &&
         toldScore(points, result.T_map_robot) < options_->recover_score;
}

double LocalMap::knownShare(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) const {
  const Point2 origin = maps_.coarse.origin();
  const core::RigidMotion2 T_map_points(T_map_robot);
  int known = 0;
  for (const auto& point : points) {
    const Point2 p_map = T_map_points * position(point);
    known += maps_.coarse.at(p_map.x - origin.x, p_map.y - origin.y) != nullptr;
  }
  return points.empty() ? 0 : static_cast<double>(known) / static_cast<double>(points.size());
}

}  // namespace slam::tracking
