#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/choices/decision.h"
#include "libslam/core/pose2.h"
#include "libslam/core/random.h"
#include "libslam/files/parameters.h"
#include "libslam/gridmap/occupancy_raster.h"
#include "libslam/lidar/scan.h"
#include "libslam/obstacles/local_obstacle_map.h"
#include "libslam/robot/drive.h"

namespace slam::strategies {

/// Where to go next. Sees the newest scan, the estimated pose and, where it needs one, the map that the robot
/// has built; never the truth.
class Strategy {
 public:
  virtual ~Strategy() = default;
  /// T_map_robot: the robot in the frame of the map that seeMap() gave; without a map any frame that stays
  /// put, such as odometry's.
  virtual choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) = 0;

  /// True when decide() works on the map. It then throws ContractError when seeMap() was never called.
  virtual bool needsMap() const { return false; }
  /// The newest map; the reference is not kept.
  virtual void seeMap(const gridmap::OccupancyRaster& /*map*/) {}
  /// What the robot was told to do since the scan before; before seeScan(). It may have done less: a
  /// collision ends a command early.
  virtual void seeCommand(const robot::Command& /*command*/) {}
  /// Every scan and where it was taken, also between the decisions; before decide() sees the same one.
  virtual void seeScan(const lidar::Scan& /*scan*/, const core::Pose2& /*T_map_robot*/) {}
  /// How uncertain the SLAM method says that the newest pose is, see choices::Certainty: before seeScan() of
  /// that scan, where the method says it.
  virtual void seeSpread(double /*spread_m*/) {}
  /// Around people whom the newest scan shows, map frame: to be kept clear of, beside the scan itself.
  virtual const std::vector<core::Point2>& people() const;
  /// Whose ways are to be planned. A strategy that is not told assumes the default robot.
  virtual void setRobot(const robot::RobotOptions& /*robot*/) {}
  /// The w in force, when it follows from the robot. A strategy that is not told has that of its options.
  virtual void setStopClearance(double /*clearance_m*/) {}
  /// True when the way is safe where the disc around the footprint fits, instead of by canMove(): its sectors
  /// of 90 degrees let nobody through a door who does not stand right before it.
  virtual bool drivesByDisc() const { return false; }
  /// Whether to go on with a decision that has a path, by the newest map: the path is free from the robot by
  /// way of path[next_waypoint] to the goal, and the goal still worth going to.
  virtual bool isStillGood(const choices::Decision& /*decision*/, const core::Pose2& /*T_map_robot*/,
                           std::size_t /*next_waypoint*/) {
    return true;
  }
  /// The other robots of the team, before every decision; a strategy that heeds none explores for itself.
  virtual void seeTeam(const std::vector<choices::Teammate>& /*team*/) {}
  /// Puts into a map of this robot, before others get it, what the strategy knows beyond it: an obstacle
  /// where a border of the unknown has turned out to be none, so that nobody else goes to look.
  virtual void annotate(gridmap::OccupancyRaster& /*map*/) const {}
  /// How a decision with a path ended: at its goal, or short of it because the way was blocked.
  virtual void tellOutcome(const choices::Decision& /*decision*/, bool /*reached*/) {}
};

/// Section [strategy].
struct StrategyOptions {
  std::string name;  ///< see strategyNames()
  double divisor_min,
      divisor_max;  ///< drive (longest ray / u), u uniform in between; the original document: 0.1 .. 2.0
  double stop_clearance_m;  ///< w of CanMove; 0: stopClearance() of the robot, the period and the noise
  double back_off_m;        ///< how far to go back when the way ahead is blocked at once
  int patience;             ///< decisions in a row without progress before a random free direction
  double wall_distance_m;   ///< of wall_follow
  double frontier_min_m;    ///< shorter frontiers do not count
  double plan_margin_m;     ///< a path keeps this and the disc's radius from every obstacle
  double comfort_m;         ///< nearer to obstacles than this a path counts as longer
  double look_m;            ///< how far beyond where it can drive the robot can look into a gap
  bool optimistic;          ///< plan through the unknown as if it were free
  /// Give up a goal on the way when what it was for has been seen: the repetitive re-checking of Holz,
  /// Basilico, Amigoni and Behnke, "Evaluating the efficiency of frontier-based exploration strategies"
  /// (ROBOTIK 2010).
  bool recheck;
  double recheck_s;         ///< how often a path is checked by the newest map
  double unknown_path_m;    ///< how far a ray is expected to go through the unknown
  double gain_min_m2;       ///< a view that is expected to show less is not worth the way
  double view_bonus_m2;     ///< added to every gain: what is left behind has to be come back for
  double lambda_per_m;      ///< next_best_view: how fast a gain loses worth with the way
  int horizon;              ///< next_best_view: views ahead, 1 = only the next one
  double slow_clearance_m;  ///< nearer to obstacles than this a path is driven more slowly
  /// "none": a drive along a ray ends before what is in its way. Else a name of goalNavigatorNames(): that
  /// navigator drives to the ray's end, at most w short of what the ray hit, and round what is in the way.
  std::string ray_navigator;
  std::string memory;                         ///< of obstacles: a name of obstacleMemoryNames()
  std::string unseen;                         ///< as NavigateOptions::unseen
  obstacles::LocalObstacleOptions obstacles;  ///< the zone of memory = local_map and unseen = looked_at
  bool revisit;          ///< go back where that is worth it for the pose's certainty, see choices::Certainty
  double revisit_price;  ///< metres of detour for a metre of it
  int give_up_after;     ///< decisions in a row that show nothing new before the strategy is stuck
  StrategyOptions();
  static const files::ParameterTable<StrategyOptions>& table();
};

/// Errors: unknown name, divisor_max below divisor_min (InputError).
std::unique_ptr<Strategy> makeStrategy(const StrategyOptions& options, core::RandomStream random);
std::vector<std::string> strategyNames();
/// One line for lists. REQUIRES a name of strategyNames() (ContractError).
std::string strategyMeaning(const std::string& name);
/// Whether it works on the map. REQUIRES a name of strategyNames() (ContractError).
bool strategyNeedsMap(const std::string& name);

}  // namespace slam::strategies
