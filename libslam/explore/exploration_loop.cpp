#include "libslam/explore/exploration_loop.h"

#include <utility>

#include "libslam/core/error.h"
#include "libslam/explore/exploration_referee.h"
#include "libslam/explore/exploring_robot.h"

namespace slam::explore {
namespace {

ExploringRobot::Place placeOf(const world::Plan& plan, const record::RecordConfig& record) {
  const core::Pose2 start = record::startPose(plan, record);
  return {start, metrics::explorableArea(plan, core::position(start),
                                         robot::circumscribedRadius(record.robot), record.lidar.max_range_m)};
}

void drive(ExploringRobot& robot, const ExploreConfig& config, core::Progress& progress,
           record::StepObserver* observer) {
  Referee referee(config.exploration);
  const double duration_s = config.record.simulation.duration_s;
  robot.begin();
  while (true) {
    const double elapsed_s = robot.elapsed_s();
    progress.update(duration_s > 0 ? elapsed_s / duration_s : 1, elapsed_s);
    robot.locate();
    if (elapsed_s + robot.period_s() / 2 >= duration_s) return robot.end(ExplorationEnd::kDuration);
    if (const auto verdict = referee.judge(elapsed_s, robot.coverage().area_m2(), robot.truth(),
                                           robot.driver().currentDecision().wait_s > 0))
      return robot.end(*verdict);
    const robot::Command command = robot.decide();
    if (observer) robot.show(*observer);
    if (robot.driver().finished()) {
      robot.end(ExplorationEnd::kFinished);
      if (robot.isReturning() || !config.exploration.return_to_start) return;
      robot.startReturn();
      referee.watchReturn();
    }
    robot.carryOut(command);
  }
}

}  // namespace

LoopResult exploreOnce(const world::Plan& given_plan, const ExploreConfig& config, const LoopMethod& method,
                       std::uint64_t seed, const std::string& folder, resources::Manifest manifest,
                       core::Progress& progress, record::StepObserver* observer) {
  const world::Plan plan = record::planOfVisit(given_plan, config.record.living, seed);
  ExploringRobot robot(plan, config, method, seed, placeOf(plan, config.record), folder);
  try {
    drive(robot, config, progress, observer);
  } catch (const core::MethodError& error) {
    if (!robot.hasLocated()) throw;
    robot.fail(error);  // what it had mapped stays
  }
  LoopResult result = robot.result();
  if (!folder.empty()) robot.writeFiles(result, std::move(manifest));
  return result;
}

}  // namespace slam::explore
