#pragma once
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "libslam/choices/certainty.h"
#include "libslam/choices/looking_map.h"
#include "libslam/choices/passers.h"
#include "libslam/choices/place_set.h"
#include "libslam/choices/viewpoint.h"
#include "libslam/paths/expected_gain.h"
#include "libslam/paths/free_space.h"
#include "libslam/paths/frontier.h"
#include "libslam/paths/path_planner.h"
#include "libslam/strategies/strategy.h"

namespace slam::strategies {

/// What a map strategy chooses from.
struct Prospects {
  const paths::FreeSpace& space;  ///< with an obstacle where a border of the unknown turned out to be one
  const paths::PathPlanner& planner;
  const std::vector<std::size_t>& frontier_cells;     ///< of `space`, ascending
  const std::vector<paths::Frontier>& frontiers;      ///< those in reach that have not been given up
  const std::vector<choices::Viewpoint>& viewpoints;  ///< by cost, never empty
  paths::LookShape view;
  core::Pose2 T_map_robot;
};

/// What the strategies on the map have in common: read the map, plan the ways, find the frontiers in reach
/// and viewpoints for them, follow up how it went, and know when nothing is left. The strategies themselves,
/// one small file each, only say which viewpoint is the best.
///
/// A frontier is in reach when the robot can drive up to it, or to at most look_m short of it in a gap that
/// it can look but not drive through. Where the lidar has measured a return there is something, also when the
/// map cannot make up its mind about the cell (a wall along the line between two cells): no frontier.
/// A viewpoint is used once, and a frontier cell is given up when it is still one after a look from close by
/// that showed nothing new, or after two looks. A goal that could not be reached is left alone for some
/// decisions and given up the second time. When the planning margin leaves nothing to do, the ways are
/// planned once more for the bare disc (see PlannerOptions::tight_start), if any frontier remains; on a large
/// map that is the next decision, so that none takes long.
/// In a team (seeTeam()) it chooses among what no other robot aims at and, of that, where it is best placed
/// (see team_share.h); when others aim at all that is left it comes after them, and waits while they are at
/// the last of it.
/// Who passes is no wall, see Passers: before it ends the robot looks again where somebody may have stood. It
/// waits where somebody holds it up, for a minute without news at most, and now and then makes way meanwhile
/// to where there is room, for people wait for a robot, too.
/// With `revisit` it goes back to where the pose was surer when that is worth the detour, see Certainty; what
/// it was about to do comes after that.
/// Finished when then no viewpoint is left for any frontier of frontier_min_m (or none that `choose` thinks
/// worth the way); the reason says how many frontiers remain out of reach and how many were given up.
class MapStrategy : public Strategy {
 public:
  explicit MapStrategy(const StrategyOptions& options)
      : options_(options), certainty_(options.revisit ? options.revisit_price : 0) {}
  choices::Decision decide(const lidar::Scan& scan, const core::Pose2& T_map_robot) final;
  bool needsMap() const final { return true; }
  bool drivesByDisc() const final { return true; }
  void seeMap(const gridmap::OccupancyRaster& map) final;
  void seeCommand(const robot::Command& command) final { passers_.tell(command); }
  void seeSpread(double spread_m) final { certainty_.tell(spread_m); }
  void seeScan(const lidar::Scan& scan, const core::Pose2& T_map_robot) final;
  const std::vector<core::Point2>& people() const final { return passers_.bodies(); }
  void setRobot(const robot::RobotOptions& robot) final { robot_ = robot; }
  bool isStillGood(const choices::Decision& decision, const core::Pose2& T_map_robot,
                   std::size_t next_waypoint) override;
  void tellOutcome(const choices::Decision& decision, bool reached) final;
  void seeTeam(const std::vector<choices::Teammate>& team) final { team_ = team; }
  void annotate(gridmap::OccupancyRaster& map) const final;

 protected:
  struct Choice {
    std::size_t viewpoint = 0;
    double score = 0;
    std::string reason;
    std::optional<double>
        look_rad;  ///< heading to look along at the goal, map frame; nothing: at the frontier
  };
  /// Nothing when no viewpoint is worth going to: then the exploration is finished.
  virtual std::optional<Choice> choose(const Prospects& prospects) = 0;
  /// Also look from places short of the frontiers.
  virtual bool wantsStandoffs() const { return true; }

  /// Gaps in walls up to this count as wall where the robot looks for frontiers, see paths::closeWalls().
  virtual double closedGap_m() const { return 0; }
  /// How many viewpoints at frontiers choose() gets at a time, the nearest first, when one of them stands for
  /// all frontiers near it. Nothing: every frontier has its own.
  virtual std::optional<std::size_t> sharedViewpoints() const { return std::nullopt; }

  const StrategyOptions& options() const { return options_; }
  const robot::RobotOptions& robot() const { return robot_; }
  /// The newest map. REQUIRES that seeMap() was called.
  const paths::FreeSpace& space() const { return *space_; }
  /// The newest decision leads to something to look at: not out of others' way, nor back for a loop.
  bool isForALook() const { return !is_making_way_ && !return_; }
  /// Looks at this frontier cell were for nothing.
  bool isGivenUp(std::size_t cell) const;

 private:
  static constexpr double kLeastNews_m2 = 0.1;  ///< less new area than this may be the map's noise
  core::PlaneCell placeOf(const core::Point2& p_map) const;
  choices::Decision decideNext(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::optional<choices::Decision> goBack(const choices::Decision& next, const core::Pose2& T_map_robot);
  /// By what is to be looked at.
  struct Looking {
    const paths::FreeSpace& space;
    const std::vector<std::size_t>& frontier_cells;  ///< of `space`, ascending
  };
  choices::Decision decideOn(const Looking& looking, const lidar::Scan& scan, const core::Pose2& T_map_robot);
  void keepMine(std::vector<choices::Viewpoint>& viewpoints);
  Looking withoutFalseFrontiers();
  void judgeLook();
  paths::PlannerOptions planning(bool bare) const;
  paths::PathPlanner plan(const core::Point2& p_map_robot);
  paths::FreeSpace bareSpace(const core::Pose2& T_map_robot) const;
  std::optional<choices::Decision> goOn(const paths::PathPlanner& planner, const Looking& looking,
                                        const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::vector<paths::Frontier> openFrontiers(const Looking& looking, const paths::PathPlanner& planner,
                                             std::size_t min_cells);
  bool seesStraight(const core::Point2& a, const core::Point2& b) const;
  std::vector<choices::Viewpoint> viewpointsFor(const paths::PathPlanner& planner,
                                                const std::vector<paths::Frontier>& frontiers) const;
  std::vector<choices::Viewpoint> withWays(const paths::PathPlanner& planner,
                                           std::vector<choices::Viewpoint> viewpoints) const;
  choices::Decision decisionFor(const paths::PathPlanner& planner,
                                const std::vector<paths::Frontier>& frontiers,
                                const std::vector<choices::Viewpoint>& viewpoints, const Choice& choice);
  bool isSpent(const core::Point2& p_map) const;
  choices::Decision finishedDecision() const;
  choices::Decision despitePeople(const lidar::Scan& scan, const core::Pose2& T_map_robot);
  std::optional<choices::Decision> wait(const core::Pose2& T_map_robot);
  std::optional<choices::Decision> makeWay(const core::Pose2& T_map_robot) const;

  StrategyOptions options_;
  robot::RobotOptions robot_;
  std::optional<paths::FreeSpace> space_;
  choices::LookingMap looking_;
  paths::PlanningGround ground_;      ///< to drive by with the margin
  std::vector<core::Point2> target_;  ///< the frontier cells that the present goal is for
  std::vector<core::Point2> spent_;   ///< viewpoints that have been looked from
  struct Failure {
    core::Point2 goal;
    int until;  ///< decision
  };
  std::vector<Failure> failures_;
  choices::PlaceSet returns_;  ///< cells in or beside which the lidar has measured a return
  std::unordered_map<core::PlaneCell, int> looks_;  ///< at frontier cells that were for nothing
  std::optional<core::Point2> looked_from_;         ///< the goal that was reached, until the next decision
  std::size_t known_before_ = 0;                    ///< cells of the map when the present goal was chosen
  int decisions_ = 0;
  choices::Passers passers_;
  choices::Certainty certainty_;
  std::optional<choices::Certainty::Return> return_;  ///< which the newest decision is for
  int waits_ = 0;                                     ///< in a row without news
  bool is_held_up_ = false;                           ///< on its way to the newest goal
  bool is_making_way_ = false;
  std::size_t known_at_wait_ = 0;
  std::vector<choices::Teammate> team_;
  bool bare_next_ = false;                        ///< the margin leaves nothing to do: plan for the bare disc
  std::size_t out_of_reach_ = 0, abandoned_ = 0;  ///< frontiers, at the newest decision
};

}  // namespace slam::strategies
