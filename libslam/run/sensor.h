#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/ini.h"
#include "libslam/core/parameters.h"
#include "libslam/robot/camera.h"
#include "libslam/robot/lidar.h"
#include "libslam/robot/scan.h"

namespace slam::run {

/// Section [sensor].
struct SensorOptions {
  std::string kind;  ///< lidar | camera
  SensorOptions();
  static const core::ParameterTable<SensorOptions>& table();
};

/// What the robot looks with.
struct SensorConfig {
  std::optional<robot::FloorCamera> camera;  ///< none: a lidar
  robot::LidarOptions lidar;                 ///< of a camera robot::asLidar(): its scans, period and range
};

/// The sections that readSensor() may read.
const std::vector<std::string>& sensorSections();

/// Reads [sensor] and then [lidar], or [camera] and [camera_scan]. InputError for what the sensor cannot be
/// (robot::requireSensible()) and for a section of the other sensor, which would have no effect.
SensorConfig readSensor(const core::IniFile& config, std::vector<core::ParameterReport>* report);

/// The configuration with what a narrow view needs where `config` says nothing: with a camera, [strategy] and
/// [navigate] memory = local_map.
core::IniFile withMemoryForCamera(const core::IniFile& config);

/// First angle and number of the beams of a scan that see as far as its maximum range, which is what a referee may
/// count as looked over: all of a lidar's; not those of a camera that the sides of its picture end.
std::pair<double, int> beamsOverFloor(const std::optional<robot::FloorCamera>& camera,
                                      const robot::Scan& scan);

}  // namespace slam::run
