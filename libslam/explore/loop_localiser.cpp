#include "libslam/explore/loop_localiser.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libslam/core/error.h"
#include "libslam/mapping/method_config.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/results/stopped_run.h"
#include "libslam/run/build_map.h"
#include "libslam/run/log_feed.h"

namespace slam::explore {

LoopMethod loadMethod(const std::string& slam, const std::string& methods_folder) {
  LoopMethod method;
  method.is_reference = slam == kTruthReference;
  // The method that believes its wheels, for perfect wheels.
  const std::string name = method.is_reference ? "naive_wheel" : slam;
  method.config = mapping::loadMethodConfig(methods_folder, name);
  method.name = resources::isConfigFile(name) ? std::filesystem::path(name).stem().string() : name;
  if (method.is_reference) method.name = kTruthReference;
  mapping::readMethodConfig(method.config);  // a bad key must not show in every run
  return method;
}

core::Pose2 Localiser::update(const sim::Sensed& sensed, const core::Pose2& T_world_robot) {
  const core::Pose2 T_previous_robot =
      is_reference_ && last_truth_ ? core::between(*last_truth_, T_world_robot) : sensed.T_previous_robot;
  last_truth_ = T_world_robot;
  core::Pose2 T_map_robot;
  run::tellSensors(builder_, sensed);
  results::insideMethod(
      [&] { T_map_robot = mapping::processScan(builder_, sensed.scan, T_previous_robot, true, commanded_); });
  if (!core::isFinite(T_map_robot)) throw core::MethodError(name_ + " diverged: its pose is not finite");
  return T_map_robot;
}

gridmap::OccupancyRaster Localiser::map() const {
  gridmap::OccupancyRaster map;
  results::insideMethod([&] { map = mapping::currentMap(builder_); });
  return map;
}

std::optional<double> Localiser::spread_m() const {
  std::optional<Eigen::Matrix3d> covariance;
  results::insideMethod([&] { covariance = mapping::poseCovariance(builder_); });
  if (!covariance || !covariance->allFinite()) return std::nullopt;
  const Eigen::Vector3d variances = covariance->diagonal();
  return std::sqrt(std::max(0.0, variances(0) + variances(1) + kArm_m * kArm_m * variances(2)));
}

}  // namespace slam::explore
