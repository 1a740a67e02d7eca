#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libslam/mrptnav/mrpt_motion.h"
#include "libslam/navigate/driver.h"
#include "libslam/robot/drive.h"
#include "libslam/strategies/strategy.h"

namespace mrpt::maps {
class COccupancyGridMap2D;
}
namespace mrpt::obs {
class CObservation2DRangeScan;
}
namespace mrpt::poses {
class CPose2D;
}

namespace slam::mrptnav {

/// The robot and its strategy, for the two classes below.
struct MrptExplorerOptions {
  strategies::StrategyOptions strategy;  ///< strategy.name: one of strategies::strategyNames()
  robot::RobotOptions robot;             ///< body and limits of speed
  double period_s = 0.2;                 ///< between two scans
  std::uint64_t seed = 1;                ///< of the strategies that draw
};

/// A strategy as one question: where to next? For robots that drive by their own means. Grids are MRPT's
/// (COccupancyGridMap2D of any metric map builder), scans and poses too; poses are in the grid's frame, for
/// strategies that need no map in any frame that stays put, such as odometry's.
class MrptStrategy {
 public:
  struct Answer {
    /// See toMrpt(Decision). Without a map a strategy says how far at most: the drive ends where the disc
    /// around the footprint would come near to a return of the scan. Empty when finished, or when there is no
    /// room ahead.
    std::vector<mrpt::math::TPose2D> path;
    bool finished = false;  ///< nothing left to explore
    std::string reason;
  };
  /// Errors: unknown name (InputError with the nearest one).
  explicit MrptStrategy(const MrptExplorerOptions& options);
  ~MrptStrategy();
  /// True when decide() works on the map.
  bool needsMap() const;
  /// The newest map; the reference is not kept.
  void seeMap(const mrpt::maps::COccupancyGridMap2D& grid);
  /// Every scan between the decisions, where there is time for it: map strategies learn from it where
  /// frontiers are walls.
  void seeScan(const mrpt::obs::CObservation2DRangeScan& scan, const mrpt::poses::CPose2D& pose);
  /// Errors: a scan that lidar::fromMrpt refuses (InputError); the strategy needs a map and has none
  /// (ContractError).
  Answer decide(const mrpt::obs::CObservation2DRangeScan& scan, const mrpt::poses::CPose2D& pose);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A strategy with its motion: one velocity command per scan, safe by the newest scan (see navigate::Driver,
/// which it wraps: the same scans, poses and maps give its commands).
///
///   if (explorer.wantsMap()) explorer.setMap(*grid);
///   robot.changeSpeeds(*explorer.next(*scan, pose).command);
class MrptExplorer {
 public:
  /// Errors: unknown name (InputError); period not positive (ContractError).
  explicit MrptExplorer(const MrptExplorerOptions& options);
  /// Built-in values but for the strategy's name.
  explicit MrptExplorer(const std::string& strategy);
  ~MrptExplorer();
  /// True when the strategy decides at the next call of next() and needs a map for that: reading a large grid
  /// costs milliseconds, so it is not asked for more often than that.
  bool wantsMap() const;
  /// The reference is not kept.
  void setMap(const mrpt::maps::COccupancyGridMap2D& grid);
  /// `collided`: the bumper cut the last command short. `finished` with a reason when nothing is left to
  /// explore, or the strategy is stuck. Errors: a scan that lidar::fromMrpt refuses (InputError); a map is
  /// needed and was never set (ContractError).
  MrptMotion next(const mrpt::obs::CObservation2DRangeScan& scan, const mrpt::poses::CPose2D& pose,
                  bool collided = false);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::mrptnav
