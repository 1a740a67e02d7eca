#include "libslam/mrptnav/mrpt_navigator.h"

#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPose2D.h>

#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::mrptnav {

MrptNavigator::MrptNavigator(const std::string& name, const mrpt::math::TPoint2D& goal,
                             const Options& options)
    : MrptNavigator(goals::makeGoalNavigator(name, options.navigate,
                                             {{goal.x, goal.y}, options.robot, options.period_s}),
                    options.period_s) {}

MrptNavigator::MrptNavigator(const std::string& name, const mrpt::math::TPoint2D& goal)
    : MrptNavigator(name, goal, Options()) {}

MrptNavigator::MrptNavigator(std::unique_ptr<goals::GoalNavigator> navigator, double period_s)
    : navigator_(std::move(navigator)), period_s_(period_s) {
  if (!navigator_) throw core::ContractError("MrptNavigator: expected a navigator");
}

MrptNavigator::~MrptNavigator() = default;

MrptMotion MrptNavigator::next(const mrpt::obs::CObservation2DRangeScan& scan,
                               const mrpt::poses::CPose2D& pose, bool collided) {
  const auto step = navigator_->next(lidar::fromMrpt(scan), lidar::fromMrpt(pose.asTPose()), collided);
  status_ = step.status;
  return {toMrpt(step.command), period_s_, step.status != goals::GoalStatus::kMoving, step.reason};
}

}  // namespace slam::mrptnav
