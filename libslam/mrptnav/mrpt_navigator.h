#pragma once
#include <mrpt/math/TPoint2D.h>

#include <memory>
#include <string>

#include "libslam/goals/goal_navigator.h"
#include "libslam/mrptnav/mrpt_motion.h"

namespace mrpt::obs {
class CObservation2DRangeScan;
}
namespace mrpt::poses {
class CPose2D;
}

namespace slam::mrptnav {

/// A goal navigator (bug algorithms, wall following, ...) for MRPT's robots: to a goal in an unknown place,
/// by scans and poses, without a map; see goals::GoalNavigator for what it promises. Goal and poses are in
/// one frame.
class MrptNavigator {
 public:
  struct Options {
    goals::NavigateOptions navigate;
    robot::RobotOptions robot;
    double period_s = 0.2;  ///< between two scans
  };
  /// name: one of goals::goalNavigatorNames(). Errors: unknown name (InputError with the nearest one);
  /// goal not finite, period not positive (ContractError).
  MrptNavigator(const std::string& name, const mrpt::math::TPoint2D& goal, const Options& options);
  /// Built-in values.
  MrptNavigator(const std::string& name, const mrpt::math::TPoint2D& goal);
  /// Any other, such as makeReactiveNavigator()'s.
  MrptNavigator(std::unique_ptr<goals::GoalNavigator> navigator, double period_s);
  ~MrptNavigator();

  /// `collided`: the bumper cut the last command short. `finished` with any final status. Errors: a scan that
  /// lidar::fromMrpt refuses (InputError).
  MrptMotion next(const mrpt::obs::CObservation2DRangeScan& scan, const mrpt::poses::CPose2D& pose,
                  bool collided = false);
  /// After the newest call.
  goals::GoalStatus status() const { return status_; }

 private:
  std::unique_ptr<goals::GoalNavigator> navigator_;
  double period_s_;
  goals::GoalStatus status_ = goals::GoalStatus::kMoving;
};

}  // namespace slam::mrptnav
