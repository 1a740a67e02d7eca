#include "libslam/methods/mrpt_method.h"

#include <mrpt/core/Clock.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimpleMap.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose3DPDF.h>
#include <mrpt/random/RandomGenerators.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <utility>

#include "libslam/builders/map_grid.h"
#include "libslam/builders/mrpt_compat.h"
#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/random.h"
#include "libslam/lidar/mrpt_types.h"

namespace slam::methods {

using mrpt::obs::CActionRobotMovement2D;

namespace {

CActionRobotMovement2D::TMotionModelOptions motionModel(const MotionOptions& motion) {
  CActionRobotMovement2D::TMotionModelOptions model;
  // The Gaussian model: Thrun's would draw samples whenever the action is copied.
  model.modelSelection = CActionRobotMovement2D::mmGaussian;
  auto& gaussian = model.gaussianModel;
  gaussian.a1 = motion.sigma_xy_per_m;
  gaussian.a2 = motion.sigma_xy_per_rad;
  gaussian.a3 = motion.sigma_turn_per_m_rad;
  gaussian.a4 = motion.sigma_turn_per_rad;
  gaussian.minStdXY = motion.sigma_xy_m;
  gaussian.minStdPHI = motion.sigma_turn_rad;
  return model;
}

/// MRPT draws from one generator per thread. It is replaced, not only seeded: a normal number that it has in
/// store would survive the seeding.
void seedMrpt(std::uint64_t seed, std::uint64_t step) {
  core::RandomStream stream(seed, "mapping step " + std::to_string(step));
  mrpt::random::getRandomGenerator() =
      mrpt::random::CRandomGenerator(static_cast<uint32_t>(stream.bits() >> 32));
}

std::shared_ptr<CActionRobotMovement2D> actionOf(
    const MethodStep& step, const CActionRobotMovement2D::TMotionModelOptions& motion_model) {
  if (step.motion.from_scans) return odometry::toMrptAction(*step.motion.from_scans, step.time_s);
  auto action = CActionRobotMovement2D::Create();
  action->computeFromOdometry(mrpt::poses::CPose2D(lidar::toMrpt(step.motion.T_previous_robot)),
                              motion_model);
  return action;
}

}  // namespace

double GridExtent::cellsWith(const core::Point2& centre, double reach_m) const {
  const double width_m = std::max(x_max, centre.x + reach_m) - std::min(x_min, centre.x - reach_m);
  const double height_m = std::max(y_max, centre.y + reach_m) - std::min(y_min, centre.y - reach_m);
  return width_m * height_m / (resolution_m * resolution_m);
}

double cellsOf(const mrpt::maps::CMultiMetricMap& maps, const core::Point2& centre, double reach_m) {
  double cells = 0;
  for (const auto& map : maps)
    if (const auto* grid = dynamic_cast<const mrpt::maps::COccupancyGridMap2D*>(&*map))
      cells += GridExtent{grid->getXMin(), grid->getXMax(), grid->getYMin(), grid->getYMax(),
                          grid->getResolution()}
                   .cellsWith(centre, reach_m);
  return cells;
}

double farthestReturn(const lidar::Scan& scan) {
  double farthest_m = 0;
  for (const float range_m : scan.ranges_m)
    if (lidar::isReturn(range_m)) farthest_m = std::max(farthest_m, static_cast<double>(range_m));
  return farthest_m;
}

std::string firstLine(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line))
    if (line.find_first_not_of(" \t=") != std::string::npos) return line;
  return text;
}

MrptMethod::MrptMethod(std::unique_ptr<mrpt::slam::CMetricMapBuilder> builder,
                       const builders::MappingOptions& mapping, const MotionOptions& motion,
                       std::uint64_t seed)
    : builder_(std::move(builder)), mapping_(mapping), motion_model_(motionModel(motion)), seed_(seed) {
  silence(*builder_);
}

core::Pose2 MrptMethod::process(const MethodStep& step) {
  const auto action = actionOf(step, motion_model_);
  double reach_m = reach(step.scan);
  for (const auto& other : step.others) reach_m = std::max(reach_m, reach(other));
  requireBoundedMap(T_map_robot_ * lidar::fromMrpt(action->poseChange->getMeanVal().asTPose()), reach_m);

  seedMrpt(seed_, step.number);
  feed(step, action);

  const auto pose = builder_->getCurrentPoseEstimation()->getMeanVal();
  const core::Pose2 T_map_robot{pose.x(), pose.y(), pose.yaw()};
  requireFinite(T_map_robot, "the pose");
  T_map_robot_ = T_map_robot;
  return T_map_robot;
}

void MrptMethod::feed(const MethodStep& step, const std::shared_ptr<CActionRobotMovement2D>& action) const {
  action->timestamp = mrpt::Clock::fromDouble(step.time_s);
  mrpt::obs::CActionCollection actions;
  actions.insert(*action);
  mrpt::obs::CSensoryFrame frame;
  lidar::addTo(frame, step.scan, step.time_s);
  for (const auto& other : step.others) lidar::addTo(frame, other, step.time_s);
  try {
    builder_->processActionObservation(actions, frame);
  } catch (const std::exception& error) {
    throw core::MethodError("MRPT: " + firstLine(error.what()));
  }
}

void MrptMethod::continueMap(const mrpt::maps::CSimpleMap& key_frames,
                             const std::optional<core::Pose2>& T_map_robot, bool keep_map) {
  SlamMethod::continueMap(key_frames, T_map_robot, keep_map);
  T_map_robot_ = T_map_robot.value_or(core::Pose2{});
}

double MrptMethod::cellsWith(const core::Point2& centre, double reach_m) const {
  return cellsOf(builders::compat::asReference(builder_->getCurrentlyBuiltMetricMap()), centre, reach_m);
}

double MrptMethod::reach(const lidar::Scan& scan) const {
  const double mount_m = core::hypot(scan.T_robot_lidar.x, scan.T_robot_lidar.y);
  return std::min(mapping_.max_insert_range_m, std::max(farthestReturn(scan), scan.max_range_m)) + mount_m;
}

/// MRPT's grids grow without limit and end the program when memory does: a diverging method has to be stopped
/// before it inserts.
void MrptMethod::requireBoundedMap(const core::Pose2& T_map_robot, double reach_m) const {
  const double cells = cellsWith(core::position(T_map_robot), reach_m);
  if (!(cells <= mapping_.max_map_cells))
    throw core::MethodError(builders::tooManyCells(cells, mapping_.max_map_cells));
}

}  // namespace slam::methods
