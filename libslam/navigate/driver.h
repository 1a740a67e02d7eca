#pragma once
#include <memory>

#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/drive.h"
#include "libslam/strategies/strategy.h"

namespace slam::navigate {

/// Turns decisions into commands of one scan period each, looks at every scan, and stops early when the way
/// ahead is blocked. Asks the strategy again when the current decision is carried out or given up.
///
/// A command is a turn in place or a straight drive, within the robot's limits. The drive stops when CanMove
/// reports the way blocked (unless the strategy drives by the disc), and never goes farther in one period
/// than the disc around the footprint can be shifted before it comes near to a return of the newest scan (a
/// margin of 2 cm and one standard deviation of the range). When nothing was driven before the stop, it goes
/// back by back_off_m where the rear is free. After `patience` decisions without progress it turns to a
/// random direction in which the disc can leave, where only the disc has to fit.
///
/// With `unseen` = looked_at no drive leads the disc over floor that has not been seen: it turns there first,
/// and back again (see LookFirst); it does not go back over such floor at all.
///
/// A drive along a ray is left to a goal navigator where `ray_navigator` names one; it has four times the
/// time of the straight drive. All of it goes by the newest scan and by what `memory` keeps.
///
/// A decision with a path is followed (see PathFollower) and checked by the newest map every recheck_s. The
/// exploration ends when the strategy says so, and as "stuck" after give_up_after decisions in a row between
/// which the map did not grow. The same scans, poses, maps and random stream give the same commands.
class Driver {
 public:
  /// Errors: period_s not positive, no strategy (ContractError).
  Driver(std::unique_ptr<strategies::Strategy> strategy, const strategies::StrategyOptions& options,
         const robot::RobotOptions& robot, double period_s, core::RandomStream random);
  ~Driver();
  /// True when the strategy needs a map and next() will decide, or has to check the path that it follows:
  /// call setMap() before next() then. Always false for strategies without a map.
  bool wantsMap() const;
  /// The newest map, for the next call of next(); the reference is not kept. May be called more often.
  void setMap(const gridmap::OccupancyRaster& map);
  /// The command for the next period. `collided`: the last command ended in a collision. T_map_robot: the
  /// robot in the frame of the map; without a map in odometry's frame. Errors: the strategy needs a map and
  /// setMap() was never called (ContractError).
  robot::Command next(const lidar::Scan& scan, const core::Pose2& T_map_robot, bool collided);
  /// In place of next() while something else drives the robot: scans are looked at, nothing is decided.
  void watch(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  /// The decision at hand is dropped, without blame: the next call of next() decides.
  void reconsider();
  /// How uncertain the pose is that the next call of next() gets, for the strategy: see
  /// Strategy::seeSpread().
  void setSpread(double spread_m);
  /// What is known of the other robots, for the strategy: see Strategy::seeTeam().
  void setTeam(const std::vector<choices::Teammate>& team);
  const strategies::Strategy& strategy() const;
  bool finished() const;
  const choices::Decision& currentDecision() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::navigate
