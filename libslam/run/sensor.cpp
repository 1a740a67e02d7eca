#include "libslam/run/sensor.h"

#include <cmath>

#include "libslam/core/error.h"

namespace slam::run {
namespace {

constexpr const char *kSection = "sensor", *kCamera = "camera";

bool isCamera(const core::IniFile& config) {
  const auto* kind = config.find(kSection, "kind");
  return kind && kind->value == kCamera;
}

}  // namespace

SensorOptions::SensorOptions() {
  table().setDefaults(*this);
}

const core::ParameterTable<SensorOptions>& SensorOptions::table() {
  using O = SensorOptions;
  static const core::ParameterTable<O> rows(
      kSection, {{"kind", &O::kind, "lidar", {"lidar", kCamera}, "what the robot looks with"}});
  return rows;
}

const std::vector<std::string>& sensorSections() {
  static const std::vector<std::string> sections = {kSection, "lidar", "camera", "camera_scan"};
  return sections;
}

SensorConfig readSensor(const core::IniFile& config, std::vector<core::ParameterReport>* report) {
  SensorOptions options;
  core::readParameters(config, SensorOptions::table(), options, report);
  const bool is_camera = options.kind == kCamera;
  for (const auto& section : sensorSections()) {
    const bool is_others = section != kSection && (section == "lidar") == is_camera;
    if (is_others && config.hasSection(section))
      throw core::InputError("section [" + section + "]: has no effect with section [sensor], key 'kind': '" +
                             options.kind + "', expected " + (is_camera ? "lidar" : kCamera) + " there");
  }
  SensorConfig sensor;
  if (!is_camera) {
    core::readParameters(config, robot::LidarOptions::table(), sensor.lidar, report);
    return sensor;
  }
  sensor.camera.emplace();
  core::readParameters(config, robot::CameraOptions::table(), sensor.camera->view, report);
  core::readParameters(config, robot::CameraScanOptions::table(), sensor.camera->scan, report);
  robot::requireSensible(*sensor.camera);
  sensor.lidar = robot::asLidar(*sensor.camera);
  return sensor;
}

core::IniFile withMemoryForCamera(const core::IniFile& config) {
  core::IniFile filled = config;
  if (!isCamera(config)) return filled;
  for (const char* section : {"strategy", "navigate"})
    if (!config.find(section, "memory")) filled.set(section, "memory", "local_map", "sensor.kind = camera");
  return filled;
}

std::pair<double, int> beamsOverFloor(const std::optional<robot::FloorCamera>& camera,
                                      const robot::Scan& scan) {
  if (!camera) return {scan.first_angle_rad, static_cast<int>(scan.ranges_m.size())};
  const double half_rad = robot::wholeHalfAngle(*camera);
  return {-half_rad, 2 * static_cast<int>(std::lround(half_rad / scan.step_rad)) + 1};
}

}  // namespace slam::run
