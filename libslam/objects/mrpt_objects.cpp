#include "libslam/objects/mrpt_objects.h"

#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <utility>

namespace slam::objects {
namespace {

mrpt::Clock::time_point timeOf(std::int64_t ticks) {
  return mrpt::Clock::time_point(mrpt::Clock::duration(ticks));
}

}  // namespace

std::int64_t ticksOf(const mrpt::obs::CObservation& observation) {
  return observation.timestamp.time_since_epoch().count();
}
std::int64_t ticksOf(const mrpt::obs::CAction& action) {
  return action.timestamp.time_since_epoch().count();
}

core::Pose2 fromMrpt(const mrpt::poses::CPose2D& pose) {
  return {pose.x(), pose.y(), pose.phi()};
}
core::Pose2 fromMrpt(const mrpt::poses::CPose3D& pose) {
  return {pose.x(), pose.y(), pose.yaw()};
}

std::shared_ptr<mrpt::obs::CObservationOdometry> makeOdometry(const core::Pose2& T_odom_robot,
                                                              std::int64_t ticks, const std::string& label) {
  auto odometry = std::make_shared<mrpt::obs::CObservationOdometry>();
  odometry->timestamp = timeOf(ticks);
  odometry->sensorLabel = label;
  odometry->odometry = mrpt::poses::CPose2D(T_odom_robot.x, T_odom_robot.y, 0);
  odometry->odometry.phi(T_odom_robot.phi);  // the constructor would wrap it
  return odometry;
}

std::shared_ptr<mrpt::obs::CObservationRobotPose> makeRobotPose(const core::Pose2& pose, std::int64_t ticks,
                                                                const std::string& label) {
  auto observation = std::make_shared<mrpt::obs::CObservationRobotPose>();
  observation->timestamp = timeOf(ticks);
  observation->sensorLabel = label;
  observation->pose.mean = mrpt::poses::CPose3D(pose.x, pose.y, 0, pose.phi, 0, 0);
  observation->pose.cov.setZero();
  return observation;
}

std::shared_ptr<mrpt::obs::CObservationComment> makeComment(std::string text, std::int64_t ticks) {
  auto comment = std::make_shared<mrpt::obs::CObservationComment>();
  comment->timestamp = timeOf(ticks);
  comment->text = std::move(text);
  return comment;
}

mrpt::obs::CActionRobotMovement2D wheelAction(const core::Pose2& T_previous_robot, std::int64_t ticks) {
  mrpt::obs::CActionRobotMovement2D movement;
  mrpt::obs::CActionRobotMovement2D::TMotionModelOptions model;
  model.modelSelection = mrpt::obs::CActionRobotMovement2D::mmGaussian;
  movement.computeFromOdometry({T_previous_robot.x, T_previous_robot.y, T_previous_robot.phi}, model);
  movement.timestamp = timeOf(ticks);
  return movement;
}

}  // namespace slam::objects
