#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"
#include "libslam/lidar/lidar.h"
#include "libslam/lidar/scan.h"
#include "libslam/robot/camera.h"
#include "libslam/robot/drive.h"
#include "libslam/sim/simulator.h"

namespace slam::record {

/// Section [sensor].
struct SensorOptions {
  std::string kind;  ///< lidar | camera
  SensorOptions();
  static const files::ParameterTable<SensorOptions>& table();
};

/// What the robot looks with.
struct SensorConfig {
  std::optional<robot::FloorCamera> camera;   ///< none: a lidar
  lidar::LidarOptions lidar;                  ///< of a camera robot::asLidar(): its scans, period and range
  std::vector<sim::NamedLidar> other_lidars;  ///< one for each section [lidar NAME], by name
};

/// The sections that readSensor() reads or refuses; those of further lidars as they stand in `config`.
std::vector<std::string> sensorSections(const files::IniFile& config);

/// Reads [sensor] and then [lidar] with [lidar NAME] for each further one, or [camera] and [camera_scan]. A
/// further lidar has the same keys as the first. InputError for what the sensor cannot be
/// (robot::requireSensible()); a section of the other sensor, which would have no effect; a name with a comma
/// or the first one's, LASER; a further lidar without a mount of its own; any lidar mounted outside of the
/// circle around the robot.
SensorConfig readSensor(const files::IniFile& config, const robot::RobotOptions& robot,
                        std::vector<files::ParameterReport>* report);

/// The configuration with what a narrow view needs where `config` says nothing. With a camera: [strategy] and
/// [navigate] memory = local_map and unseen = looked_at, remembered points 2 cm apart, and a [strategy]
/// stop_clearance_m that reaches a step beyond the dead zone, or CanMove would never see what it asks for.
files::IniFile withCameraDefaults(const files::IniFile& config,
                                  const std::optional<robot::FloorCamera>& camera,
                                  const robot::RobotOptions& robot);

/// First angle and number of the beams of a scan that see as far as its maximum range, which is what a
/// referee may count as looked over: all of a lidar's; not those of a camera that the sides of its picture
/// end.
std::pair<double, int> beamsOverFloor(const std::optional<robot::FloorCamera>& camera,
                                      const lidar::Scan& scan);

}  // namespace slam::record
