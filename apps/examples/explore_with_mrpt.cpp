// MRPT's own RBPF SLAM maps a simulated world while our strategy tells the robot where to go.
#include <mrpt/config/CConfigFile.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/random/RandomGenerators.h>
#include <mrpt/slam/CMetricMapBuilderRBPF.h>
#include "libslam/builders/mrpt_compat.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/mrptnav/mrpt_explorer.h"
#include "libslam/record/record.h"
#include "libslam/resources/resources.h"

int main() {
  const auto plan = slam::world::loadPlan(slam::resources::resolvePlan("flat"));
  const auto start = slam::record::startPose(plan, slam::record::readRecordConfig({}));
  slam::sim::Simulator robot(plan, {}, {}, {}, start, /*seed=*/1);
  mrpt::random::getRandomGenerator().randomize(1);
  mrpt::slam::CMetricMapBuilderRBPF::TConstructionOptions options;
  const mrpt::config::CConfigFile config(slam::resources::configsFolder() + "/mrpt/rbpf-slam.ini");
  options.loadFromConfigFile(config, "MappingApplication");
  mrpt::slam::CMetricMapBuilderRBPF slam(options);
  slam::mrptnav::MrptExplorer explorer("nearest_frontier");
  slam::mrptnav::MrptMotion motion;
  for (auto sensed = robot.sense(); !motion.finished;) {
    mrpt::obs::CActionRobotMovement2D wheels;
    wheels.computeFromOdometry(mrpt::poses::CPose2D(slam::lidar::toMrpt(sensed.T_previous_robot)), {});
    const auto scan = slam::lidar::toMrpt(sensed.scan);
    mrpt::obs::CActionCollection actions(wheels);
    mrpt::obs::CSensoryFrame frame;
    frame.insert(scan);
    slam.processActionObservation(actions, frame);
    const auto& maps = slam::builders::compat::asReference(slam.getCurrentlyBuiltMetricMap());
    const auto map = maps.mapByClass<mrpt::maps::COccupancyGridMap2D>();
    const mrpt::poses::CPose2D pose(slam.getCurrentPoseEstimation()->getMeanVal());
    if (explorer.wantsMap()) explorer.setMap(*map);
    motion = explorer.next(*scan, pose, sensed.collided);
    sensed = robot.step({motion.command->lin_vel, motion.command->ang_vel, motion.duration_s});
    if (motion.finished) map->saveAsBitmapFile("map.png");
  }
  std::puts(motion.reason.c_str());
}
