#include "libslam/mrptnav/mrpt_explorer.h"
#include "libslam/navigate/driver.h"

#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/poses/CPose2D.h>

#include <algorithm>

#include "libslam/gridmap/mrpt_grid.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/safety/safe_motion.h"

namespace slam::mrptnav {
namespace {

core::Pose2 toPose(const mrpt::poses::CPose2D& pose) {
  return lidar::fromMrpt(pose.asTPose());
}

std::unique_ptr<strategies::Strategy> strategyOf(const MrptExplorerOptions& options) {
  return strategies::makeStrategy(options.strategy, {options.seed, "strategy"});
}

MrptExplorerOptions withName(const std::string& strategy) {
  MrptExplorerOptions options;
  options.strategy.name = strategy;
  return options;
}

}  // namespace

struct MrptStrategy::State {
  std::unique_ptr<strategies::Strategy> strategy;
  robot::RobotOptions robot;
};

MrptStrategy::MrptStrategy(const MrptExplorerOptions& options)
    : state_(std::make_unique<State>(State{strategyOf(options), options.robot})) {
  state_->strategy->setRobot(options.robot);
}
MrptStrategy::~MrptStrategy() = default;

bool MrptStrategy::needsMap() const {
  return state_->strategy->needsMap();
}

void MrptStrategy::seeMap(const mrpt::maps::COccupancyGridMap2D& grid) {
  state_->strategy->seeMap(gridmap::fromMrpt(grid));
}

void MrptStrategy::seeScan(const mrpt::obs::CObservation2DRangeScan& scan, const mrpt::poses::CPose2D& pose) {
  state_->strategy->seeScan(lidar::fromMrpt(scan), toPose(pose));
}

MrptStrategy::Answer MrptStrategy::decide(const mrpt::obs::CObservation2DRangeScan& scan,
                                          const mrpt::poses::CPose2D& pose) {
  const auto seen = lidar::fromMrpt(scan);
  const auto T_map_robot = toPose(pose);
  state_->strategy->seeScan(seen, T_map_robot);
  auto decision = state_->strategy->decide(seen, T_map_robot);
  // Without a map a strategy says how far at most; a driver of ours stops where the way ends.
  decision.distance_m = std::min(
      {decision.distance_m, seen.max_range_m, safety::discReach(seen, decision.turn_rad, state_->robot)});
  return {toMrpt(decision, T_map_robot), decision.finished, decision.reason};
}

struct MrptExplorer::State {
  explicit State(const MrptExplorerOptions& options)
      : period_s(options.period_s),
        driver(strategyOf(options), options.strategy, options.robot, options.period_s,
               {options.seed, "driver"}) {}
  double period_s;
  navigate::Driver driver;
};

MrptExplorer::MrptExplorer(const MrptExplorerOptions& options) : state_(std::make_unique<State>(options)) {}
MrptExplorer::MrptExplorer(const std::string& strategy) : MrptExplorer(withName(strategy)) {}
MrptExplorer::~MrptExplorer() = default;

bool MrptExplorer::wantsMap() const {
  return state_->driver.wantsMap();
}

void MrptExplorer::setMap(const mrpt::maps::COccupancyGridMap2D& grid) {
  state_->driver.setMap(gridmap::fromMrpt(grid));
}

MrptMotion MrptExplorer::next(const mrpt::obs::CObservation2DRangeScan& scan,
                              const mrpt::poses::CPose2D& pose, bool collided) {
  auto& driver = state_->driver;
  const auto command = driver.next(lidar::fromMrpt(scan), toPose(pose), collided);
  return {toMrpt(command), state_->period_s, driver.finished(), driver.currentDecision().reason};
}

}  // namespace slam::mrptnav
