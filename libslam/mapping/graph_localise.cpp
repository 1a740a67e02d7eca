#include <algorithm>
#include <cmath>

#include "libslam/core/error.h"
#include "libslam/mapping/graph_search.h"
#include "libslam/mapping/graph_slam.h"

namespace slam::mapping {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;

/// Where less of a scan than this falls on what is mapped, the robot has left the map.
constexpr double kLeastKnown = 0.5;
/// A place that may be the right one is looked at again after so much way or turn.
constexpr double kFollow_m = 0.3, kFollow_rad = 0.3;
constexpr int kMostFailures = 2, kMostRefound = 4;
/// Two of them are the same.
constexpr double kSame_m = 0.5, kSame_rad = 0.2;
constexpr int kAnyComponent = -2;

}  // namespace

void GraphSlam::startAnywhere() {
  if (keyframes_.empty()) throw core::ContractError("GraphSlam: startAnywhere() without a map");
  startAt(graph_.pose(0));
  is_lost_ = true;
  note("lost", 0);
}

GraphSlam::Step GraphSlam::localise(const robot::Scan& scan, const Pose2& T_previous_robot,
                                    bool has_odometry) {
  if (keyframes_.empty()) throw core::ContractError("GraphSlam: localise() without a map");
  std::vector<PatchPoint> points;
  Eigen::Matrix3d information;
  noteTime(scan, has_odometry);
  const Pose2 increment = has_odometry ? T_previous_robot : T_previous_robot_;
  const Pose2 predicted = currentPose() * increment;
  Step step;
  if (is_lost_) {
    points = pointsOf(scan);
    step.score = 0;
    step.T_map_robot = predicted;
    ++held_back_;
    keepTo(predicted, increment, step);
    searchOnePlace(points, predicted);
    if (followRefound(points, increment, step)) {
      is_lost_ = false;
      held_back_ = 0;
      lost_.restart();
      refound_.clear();
      note("recovered", step.score);
    }
  } else {
    const Pose2 T_before = currentPose();
    step = track(scan, T_previous_robot, has_odometry, points, information);
    const Break seam = breakBefore(scan, points, increment, core::between(T_before, step.T_map_robot));
    lookWhetherLost(points, step, scan.time_s, increment, seam.contradicted);
    // Who has walked out of the map is not looked for: his wheels will bring him back. What little fits would lead astray;
    // and he is back when a scan fits, not when some of it does.
    const bool was_outside = is_outside_;
    MatchResult matched;
    is_outside_ = knownShare(points, predicted) < kLeastKnown ||
                  (was_outside && !fitsMap(points, step.T_map_robot, matched));
    if (is_outside_ != was_outside) note(is_outside_ ? "outside" : "inside", step.score);
    if (is_outside_ || lost_.isInDoubt()) {
      ++held_back_;
      keepTo(predicted, increment, step);
    } else {
      held_back_ = 0;
    }
    if (lost_.isLost()) {
      note("lost", step.score);
      is_lost_ = true, is_outside_ = false;
      lost_.restart();
      refound_.clear();
    }
  }
  odometry_holds_ = false;
  T_keyframe_robot_ = core::between(graph_.pose(lastKeyframe()), step.T_map_robot);
  if (!is_lost_) setMapNear(core::position(step.T_map_robot));
  records_.push_back({lastKeyframe(), T_keyframe_robot_, step.match_covariance});
  previous_scan_ = scan;
  return step;
}

/// Looks whether the robot is at the next place of the map. What it may be is followed from then on.
void GraphSlam::searchOnePlace(const std::vector<PatchPoint>& points, const Pose2& T_map_robot) {
  const auto& places = placesBeyond(kAnyComponent);
  const size_t turn = places_tried_++;
  const int place = places[turn / kHeadings % places.size()];
  if (turn % kHeadings == 0)
    for (auto& refound : refound_) --refound.places_left;
  const auto matched =
      matchAtPlace(points, place, T_map_robot.phi + static_cast<double>(turn % kHeadings) * kHeadingStep_rad);
  if (!matched || static_cast<int>(refound_.size()) >= kMostRefound) return;
  for (const auto& known : refound_)
    if (core::distance(known.T_map_robot, matched->T_map_robot) < kSame_m &&
        std::abs(core::angleDifference(known.T_map_robot.phi, matched->T_map_robot.phi)) < kSame_rad)
      return;
  Refound refound;
  refound.T_map_robot = refound.T_map_looked = matched->T_map_robot;
  refound.begun_at = core::position(matched->T_map_robot);
  refound.score = matched->score;
  refound.places_left = static_cast<int>(places.size()) - 1;
  refound_.push_back(refound);
}

/// Whether a scan as a whole fits the map near a pose: explained, and seen through by no beam.
bool GraphSlam::fitsMap(const std::vector<PatchPoint>& points, const Pose2& T_map_robot,
                        MatchResult& matched) const {
  const auto around =
      firstOf(keyframesWithin(core::position(T_map_robot), options_.map_radius_m), options_.map_keyframes);
  if (around.empty()) return false;
  matched = matchFreely(points, around, T_map_robot);
  return matched.score >= options_.recover_score &&
         core::distance(matched.T_map_robot, T_map_robot) < kSame_m &&
         std::abs(core::angleDifference(matched.T_map_robot.phi, T_map_robot.phi)) < kSame_rad &&
         meanConflict(firstOf(around, kViewers), matched.T_map_robot, points) < options_.loop_conflict;
}

/// Moves on with all places that may be the right one. True when only one is left, of the whole map, that more than a room
/// was followed from.
bool GraphSlam::followRefound(const std::vector<PatchPoint>& points, const Pose2& increment, Step& step) {
  for (size_t i = 0; i < refound_.size();) {
    Refound& refound = refound_[i];
    refound.T_map_robot = refound.T_map_robot * increment;
    if (core::distance(refound.T_map_robot, refound.T_map_looked) > kFollow_m ||
        std::abs(core::angleDifference(refound.T_map_robot.phi, refound.T_map_looked.phi)) > kFollow_rad) {
      MatchResult matched;
      if (fitsMap(points, refound.T_map_robot, matched)) {
        refound.T_map_robot = matched.T_map_robot;
        refound.score = matched.score;
        refound.extent_m =
            std::max(refound.extent_m, core::distance(refound.begun_at, core::position(matched.T_map_robot)));
        refound.failures = std::max(refound.failures - 1, 0);
      } else {
        ++refound.failures;
      }
      refound.T_map_looked = refound.T_map_robot;
    }
    if (refound.failures > kMostFailures)
      refound_.erase(refound_.begin() + static_cast<long>(i));
    else
      ++i;
  }
  if (refound_.size() != 1 || refound_[0].failures > 0 || refound_[0].places_left > 0 ||
      refound_[0].extent_m < kJoinExtent_m)
    return false;
  step.T_map_robot = refound_[0].T_map_robot;
  step.score = refound_[0].score;
  return true;
}

}  // namespace slam::mapping
