#include "libslam/rawlogs/log_motion.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>

#include <algorithm>
#include <utility>

#include "libslam/objects/mrpt_objects.h"

namespace slam::rawlogs {
namespace {

// Odometry that waits for a scan of its time. More than this means that the two clocks do not agree; then the
// order in the file is the better guide.
constexpr size_t kMostWaitingReadings = 1000;

}  // namespace

std::optional<core::Pose2> incrementOf(const mrpt::obs::CActionCollection& actions) {
  using mrpt::obs::CActionRobotMovement2D;
  std::optional<core::Pose2> matched, spatial;
  for (const auto& action : actions) {
    if (const auto* planar = dynamic_cast<const CActionRobotMovement2D*>(action.get())) {
      if (planar->estimationMethod == CActionRobotMovement2D::emOdometry)
        return objects::fromMrpt(planar->rawOdometryIncrementReading);
      if (!matched && planar->poseChange) matched = objects::fromMrpt(planar->poseChange->getMeanVal());
    } else if (const auto* full = dynamic_cast<const mrpt::obs::CActionRobotMovement3D*>(action.get())) {
      if (!spatial) spatial = objects::fromMrpt(full->poseChange.mean);
    }
  }
  return matched ? matched : spatial;
}

void BareOdometry::add(std::int64_t ticks, const core::Pose2& T_odom_robot) {
  waiting_.push_back({ticks, T_odom_robot});
  if (waiting_.size() <= kMostWaitingReadings) return;
  use(waiting_.front());
  waiting_.pop_front();
}

Motion BareOdometry::takeUntil(std::int64_t scan_ticks) {
  const auto is_due = [scan_ticks](const Reading& reading) { return reading.ticks <= scan_ticks; };
  const auto end = std::find_if(waiting_.rbegin(), waiting_.rend(), is_due).base();
  // Also through those of later stamps: they are absolute, so what they add the next one takes back.
  for (auto reading = waiting_.begin(); reading != end; ++reading) use(*reading);
  waiting_.erase(waiting_.begin(), end);
  return std::exchange(motion_, Motion{});
}

void BareOdometry::use(const Reading& reading) {
  if (last_) motion_.add(core::between(*last_, reading.T_odom_robot));
  last_ = reading.T_odom_robot;
  motion_.has_reading = true;
}

}  // namespace slam::rawlogs
