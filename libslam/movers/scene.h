#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/movers/crowd.h"
#include "libslam/movers/disc.h"
#include "libslam/movers/doors.h"
#include "libslam/movers/living.h"
#include "libslam/rays/sector_caster.h"
#include "libslam/world/plan.h"

namespace slam::movers {

/// What stands around the robot at the present moment: what a ray meets and what a body bumps into. Walls,
/// doors that are closed, people.
class Scene {
 public:
  /// Keeps a reference to `plan`, which must outlive it and not change. `robot`: its disc at the start, world
  /// frame. InputError where there is no room for the people, or doors are to move and the plan has none.
  Scene(const world::Plan& plan, const LivingOptions& living, std::uint64_t seed, const Disc& robot);
  /// Nothing moves.
  explicit Scene(const world::Plan& plan);
  ~Scene();

  /// The plan as it is now: the cells of a closed door are occupied.
  const world::Plan& plan() const { return changing_ ? *changing_ : plan_; }
  const world::Plan& planWithDoorsOpen() const { return plan_; }
  /// As rays::castScan(), and people are met like walls.
  void castScan(const core::Pose2& T_world_lidar, const rays::BeamTable& beams, double max_range_m,
                std::vector<float>& out_ranges_m) const;
  /// As rays::castRay(), and people are met like walls.
  double castRay(const core::Point2& p_world, double angle_rad, double max_range_m) const;
  /// As rays::castOriginalRay(), and people are met as by castRay(), in whole cells too.
  double castOriginalRay(const core::Point2& p_world, double angle_rad, double max_range_m) const;
  /// As world::discCollides(); and people count.
  bool discCollides(const core::Point2& p_world, double radius_m) const;
  /// What the lidar meets besides the plan, world frame.
  const std::vector<Disc>& bodies() const { return bodies_; }
  /// Other robots, world frame: met and bumped into like people, until they are set again.
  void setRobots(const std::vector<Disc>& robots);
  /// Whether a disc overlaps one of them.
  bool touchesRobot(const core::Point2& p_world, double radius_m) const;

  /// True when time changes anything: then tick() is owed at every whole multiple of kTick_ns.
  bool isAlive() const { return crowd_ || doors_; }
  /// Moves people and doors, given where the robot is now. Between two ticks they stand still.
  void tick(const Disc& robot);
  /// The robot was kidnapped to where it is now.
  void noteCarried(const Disc& robot);
  /// nullptr when there is none.
  const Crowd* crowd() const { return crowd_.get(); }
  const Doors* doors() const { return doors_.get(); }

 private:
  /// Of the nearest body met before range_m; range_m when there is none.
  double castBodies(const core::Point2& p_world, double angle_rad, double range_m, double max_range_m) const;
  Disc toPlanFrame(const Disc& robot) const;
  void moveDoors(const Disc& robot_in_plan);
  void setDoor(const world::Door& door, world::Cell cell);
  void placeBodies();

  const world::Plan& plan_;
  std::unique_ptr<world::Plan> changing_;  ///< a copy, when there are doors that move
  rays::SectorCaster caster_;
  std::unique_ptr<Crowd> crowd_;
  std::unique_ptr<Doors> doors_;
  std::vector<Disc> bodies_, persons_;  ///< world frame: what a lidar meets, and what a body bumps into
  std::vector<Disc> robots_;            ///< world frame; they are in the two above as well
};

}  // namespace slam::movers
