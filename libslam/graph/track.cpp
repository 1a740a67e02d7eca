#include <Eigen/Eigenvalues>
#include <algorithm>
#include <optional>
#include <utility>

#include "libslam/graph/graph_slam.h"
#include "libslam/keyframes/matching.h"
#include "libslam/scanmatch/information.h"

namespace slam::graph {
namespace {

using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;

/// Least share of the information along the worst direction of movement; below, a corridor or an open field.
constexpr double kDegenerate = 0.02;

/// Of the direction of movement that a match holds least, against the best; 0 where it holds none.
double worstShare(const MatchResult& result) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> movement(result.information.topLeftCorner<2, 2>(),
                                                                Eigen::EigenvaluesOnly);
  return movement.eigenvalues()(1) > 0 ? std::max(movement.eigenvalues()(0), 0.0) / movement.eigenvalues()(1)
                                       : 0;
}

}  // namespace

void GraphSlam::setMapHere() {
  around().fillAround(anchor_, currentPose());
}

/// Matches a scan to the map around, and deskews what its sweep still holds. Fills in its points and the
/// information that they give, map axes.
GraphSlam::Step GraphSlam::track(lidar::Scan& scan, const Pose2& T_previous_robot, bool has_odometry,
                                 std::vector<PatchPoint>& points, Eigen::Matrix3d& information) {
  points = keyframes::pointsOf(scan, options_);
  const tracking::Expected e = tracker_.expect(currentPose(), T_previous_robot, has_odometry);
  auto [result, is_odometry_dropped] = tracker_.match(scan, points, e);
  auto unskewed = tracker_.unskew(scan, points, e, result);
  if (unskewed) {
    result.T_map_robot = unskewed->match.T_map_robot, result.score = unskewed->match.score;
    points = std::move(unskewed->points), scan = std::move(unskewed->scan);
  }
  const Pose2& T = result.T_map_robot;
  const bool is_poor = around().isPoor(result, points);
  if (is_poor) map_->note(core::JournalEvent::kPoor, result.score);
  const double share = worstShare(result);
  if (share < kDegenerate) map_->note(core::JournalEvent::kDegenerate, share);

  odometry_holds_ = odometry_holds_ && has_odometry && !is_odometry_dropped;
  tracker_.noteMatch(T, points, e, !is_poor);
  const Pose2 matched = core::between(e.T_before, T);
  motion().setStep(matched);
  T_keyframe_robot_ = core::between(map_->pose(anchor_), T);
  T_odometry_ = T_odometry_ * e.step.T_previous_robot;
  map_->drive(core::hypot(matched.x, matched.y));
  Step step;
  step.T_map_robot = T;
  step.score = result.score;
  uncertainty_.noteEvidence(points, T, around().maps().fine);
  if (has_odometry && !is_poor && doubt_.begins < 0 && held_back_ == 0)
    learnWheels(e, matched, keyframes::toldInformation(uncertainty_.evidence()), result.posterior_information,
                !is_odometry_dropped);
  else
    motion().learnNothing();
  uncertainty_.carryOn(e, result, unskewed ? std::optional(unskewed->noise) : std::nullopt);
  information = uncertainty_.toldInformation();
  step.drift_covariance = uncertainty_.sinceKeyframe(anchor_);
  step.pose_covariance = uncertainty_.covariance();
  return step;
}

/// How far the robot went and turned beside what odometry says; of a step that is not believed, only whether
/// it went the other way.
void GraphSlam::learnWheels(const tracking::Expected& e, const Pose2& matched,
                            const Eigen::Matrix3d& information, const Eigen::Matrix3d& posterior_information,
                            bool is_believed) {
  const Pose2& step = e.step.T_previous_robot;
  const auto told = scanmatch::toldShares(information, posterior_information, step, e.T_before.phi);
  motion().learn(step, matched, told.way, told.turn, is_believed && !tracker_.isFollowingWheels());
}

/// Puts odometry's word in place of a match.
void GraphSlam::keepTo(const Pose2& predicted, const Pose2& increment, Step& step) {
  step.T_map_robot = predicted;
  const Eigen::Matrix3d drift = held_back_ * scanmatch::covarianceOf(scanmatch::poseInformation(
                                                 options_.odometry_xy_m, options_.odometry_turn_rad));
  step.drift_covariance += drift;
  step.pose_covariance += drift;
  motion().setStep(increment);
  motion().learnNothing();
  T_keyframe_robot_ = core::between(map_->pose(anchor_), predicted);
}

}  // namespace slam::graph
