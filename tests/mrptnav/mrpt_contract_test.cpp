// Every strategy and navigator through MRPT's types: the same decisions and commands as through ours.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/poses/CPose3D.h>

#include <cmath>

#include "libslam/core/error.h"
#include "libslam/gridmap/mrpt_grid.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/mrptnav/mrpt_explorer.h"
#include "libslam/mrptnav/mrpt_navigator.h"
#include "libslam/mrptnav/reactive_navigator.h"
#include "libslam/navigate/driver.h"
#include "libslam/sim/simulator.h"
#include "libslam/world/plan.h"

namespace slam::mrptnav {
namespace {

using mrpt::maps::COccupancyGridMap2D;
using mrpt::poses::CPose2D;
using world::Cell;

constexpr double kPeriod_s = 0.2;
const core::Pose2 kStart{2, 2, 0.3};

/// Two rooms of 5 x 4 m and a door of 1.2 m between them.
world::Plan twoRooms() {
  world::Plan plan;
  plan.name = "two rooms";
  plan.columns = 208;
  plan.rows = 84;
  plan.cells.assign(static_cast<size_t>(plan.columns) * plan.rows, Cell::kOccupied);
  for (int row = 2; row < plan.rows - 2; ++row)
    for (int column = 2; column < plan.columns - 2; ++column)
      if (column < 102 || column > 105 || (row > 50 && row < 75))
        plan.cells[static_cast<size_t>(row) * plan.columns + column] = Cell::kFree;
  return plan;
}

lidar::LidarOptions lidar() {
  lidar::LidarOptions options;
  options.fov_rad = core::degToRad(270);
  options.beams = 541;
  options.max_range_m = 8;
  options.rate_hz = 1 / kPeriod_s;
  return options;
}

robot::Command commandOf(const MrptMotion& motion) {
  return {motion.command->lin_vel, motion.command->ang_vel, motion.duration_s};
}

void expectSame(const MrptMotion& motion, const robot::Command& command, int step) {
  ASSERT_TRUE(motion.command);
  EXPECT_EQ(motion.command->lin_vel, command.speed_mps) << step;
  EXPECT_EQ(motion.command->ang_vel, command.turn_rate_radps) << step;
  EXPECT_EQ(motion.duration_s, kPeriod_s);
}

/// A drive in the true frame with a map of MRPT's grid, which each scan is inserted to.
class Drive {
 public:
  Drive() : simulator_(plan_, {}, lidar(), {}, kStart, 5), grid_(-1, 12, -1, 6, 0.05F) {
    take(simulator_.sense());
  }

  void step(const robot::Command& command) {
    const auto before = simulator_.truth();
    take(simulator_.step(command));
    driven_m += core::distance(before, simulator_.truth());
  }
  CPose2D pose() const { return CPose2D(lidar::toMrpt(simulator_.truth())); }
  const core::Pose2& ourPose() const { return simulator_.truth(); }
  const COccupancyGridMap2D& grid() const { return grid_; }
  const mrpt::obs::CObservation2DRangeScan& scan() const { return *scan_; }
  /// What the adapters see of the scan: in MRPT's single precision.
  lidar::Scan ourScan() const { return lidar::fromMrpt(*scan_); }
  bool collided() const { return collided_; }
  size_t collisions() const { return simulator_.collisions().size(); }

  double driven_m = 0;

 private:
  void take(const sim::Sensed& sensed) {
    scan_ = lidar::toMrpt(sensed.scan);
    collided_ = sensed.collided;
    grid_.insertObservation(*scan_, mrpt::poses::CPose3D(pose()));
  }
  const world::Plan plan_ = twoRooms();
  sim::Simulator simulator_;
  COccupancyGridMap2D grid_;
  std::shared_ptr<mrpt::obs::CObservation2DRangeScan> scan_;
  bool collided_ = false;
};

MrptExplorerOptions optionsOf(const std::string& strategy) {
  MrptExplorerOptions options;
  options.strategy.name = strategy;
  options.period_s = kPeriod_s;
  options.seed = 3;
  return options;
}

class EveryStrategy : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryStrategy, DrivesAsItsDriverDoesAndExploresWithoutACollision) {
  const auto options = optionsOf(GetParam());
  MrptExplorer explorer(options);
  navigate::Driver driver(strategies::makeStrategy(options.strategy, {options.seed, "strategy"}),
                          options.strategy, options.robot, kPeriod_s, {options.seed, "driver"});
  Drive drive;
  for (int step = 0; step < 150 && !driver.finished(); ++step) {
    ASSERT_EQ(explorer.wantsMap(), driver.wantsMap());
    if (driver.wantsMap()) {
      driver.setMap(gridmap::fromMrpt(drive.grid()));
      explorer.setMap(drive.grid());
    }
    const auto command = driver.next(drive.ourScan(), drive.ourPose(), drive.collided());
    const auto motion = explorer.next(drive.scan(), drive.pose(), drive.collided());
    expectSame(motion, command, step);
    EXPECT_EQ(motion.finished, driver.finished());
    EXPECT_EQ(motion.reason, driver.currentDecision().reason);
    EXPECT_LE(std::abs(motion.command->lin_vel), options.robot.max_speed_mps + 1e-9);
    drive.step(commandOf(motion));
  }
  EXPECT_GT(drive.driven_m, 1) << "it explores";
  EXPECT_EQ(drive.collisions(), 0U);
}

TEST_P(EveryStrategy, AnswersWithAPathOfPosesOnFreeGround) {
  MrptStrategy strategy(optionsOf(GetParam()));
  EXPECT_EQ(strategy.needsMap(), strategies::strategyNeedsMap(GetParam()));
  Drive drive;
  if (strategy.needsMap()) {
    EXPECT_THROW(strategy.decide(drive.scan(), drive.pose()), core::ContractError);
    strategy.seeMap(drive.grid());
  }
  strategy.seeScan(drive.scan(), drive.pose());
  const auto answer = strategy.decide(drive.scan(), drive.pose());
  ASSERT_FALSE(answer.finished) << answer.reason;
  EXPECT_NE(answer.reason, "");
  ASSERT_FALSE(answer.path.empty());
  for (const auto& pose : answer.path) {
    EXPECT_TRUE(std::isfinite(pose.phi));
    EXPECT_GT(drive.grid().getPos(static_cast<float>(pose.x), static_cast<float>(pose.y)), 0.5F)
        << pose.x << " " << pose.y << " is not known to be free";
  }
}

INSTANTIATE_TEST_SUITE_P(Strategies, EveryStrategy, ::testing::ValuesIn(strategies::strategyNames()),
                         [](const auto& test) { return test.param; });

class EveryNavigator : public ::testing::TestWithParam<std::string> {};

TEST_P(EveryNavigator, DrivesToTheGoalByTheCommandsThatItGivesAnyway) {
  const mrpt::math::TPoint2D goal(4.2, 1.2);
  goals::NavigateOptions limits;
  MrptNavigator navigator(GetParam(), goal);
  const auto twin = goals::makeGoalNavigator(GetParam(), limits, {{goal.x, goal.y}, {}, kPeriod_s});
  Drive drive;
  MrptMotion motion;
  for (int step = 0; step < 1500 && !motion.finished; ++step) {
    const auto expected = twin->next(drive.ourScan(), drive.ourPose(), drive.collided());
    motion = navigator.next(drive.scan(), drive.pose(), drive.collided());
    expectSame(motion, expected.command, step);
    EXPECT_EQ(navigator.status(), expected.status);
    drive.step(commandOf(motion));
  }
  EXPECT_EQ(navigator.status(), goals::GoalStatus::kReached) << motion.reason;
  EXPECT_LT(drive.pose().distance2DTo(goal.x, goal.y), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Navigators, EveryNavigator, ::testing::ValuesIn(goals::goalNavigatorNames()),
                         [](const auto& test) { return test.param; });

TEST(MrptNavigator, TakesMrptsOwnReactiveNavigationToo) {
  if (!reactiveNavigationAvailable()) GTEST_SKIP() << "built without MRPT's module nav";
  ReactiveOptions reactive;
  reactive.look_ahead_m = 2;
  goals::GoalTask task;
  task.p_odom_goal = {4.2, 1.2};
  MrptNavigator navigator(makeReactiveNavigator(reactive, {}, task), kPeriod_s);
  Drive drive;
  MrptMotion motion;
  for (int step = 0; step < 300 && !motion.finished; ++step) {
    motion = navigator.next(drive.scan(), drive.pose(), drive.collided());
    drive.step(commandOf(motion));
  }
  EXPECT_EQ(navigator.status(), goals::GoalStatus::kReached) << motion.reason;
}

TEST(MrptExplorer, SaysWhichStrategiesThereAre) {
  try {
    MrptExplorer explorer("nearest_frontir");
    FAIL();
  } catch (const core::InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("did you mean 'nearest_frontier'?"));
  }
}

TEST(ToMrptPath, OfATurnAndADriveIsTheTurnedRobotAndTheEnd) {
  choices::Decision decision;
  decision.turn_rad = core::kPi / 2;
  decision.distance_m = 2;
  const auto path = toMrpt(decision, {1, 1, 0});
  ASSERT_EQ(path.size(), 2U);
  EXPECT_NEAR(path[0].x, 1, 1e-12);
  EXPECT_NEAR(path[0].phi, core::kPi / 2, 1e-12);
  EXPECT_NEAR(path[1].y, 3, 1e-12);
  decision.finished = true;
  EXPECT_TRUE(toMrpt(decision, {1, 1, 0}).empty());
}

TEST(ToMrptPath, OfWaypointsLooksAlongTheWayAndAtTheEndAtWhatIsToBeSeen) {
  choices::Decision decision;
  decision.path = {{1, 0}, {1, 2}, {1, 2}};
  decision.look_at = core::Point2{0, 2};
  const auto path = toMrpt(decision, {});
  ASSERT_EQ(path.size(), 3U);
  EXPECT_NEAR(path[0].phi, 0, 1e-12);
  EXPECT_NEAR(path[1].phi, core::kPi / 2, 1e-12);
  EXPECT_NEAR(std::abs(path[2].phi), core::kPi, 1e-12);
}

TEST(GridFromMrpt, KeepsPlacesAndTellsFreeOccupiedAndUnknownApart) {
  COccupancyGridMap2D grid(-1, 2, 0, 1, 0.1F);
  grid.setPos(0.55F, 0.25F, 0.05F);  // MRPT's probability is that of free ground
  grid.setPos(-0.55F, 0.75F, 0.95F);
  const auto raster = gridmap::fromMrpt(grid);
  EXPECT_EQ(raster.resolution_m, 0.1);
  EXPECT_GT(raster.at(raster.columnOf(0.55), raster.rowOf(0.25)), gridmap::kOccupiedAbove);
  EXPECT_LT(raster.at(raster.columnOf(-0.55), raster.rowOf(0.75)), gridmap::kFreeBelow);
  EXPECT_EQ(raster.at(raster.columnOf(1), raster.rowOf(0.5)), 0.5F);
}

}  // namespace
}  // namespace slam::mrptnav
