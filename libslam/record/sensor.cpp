#include "libslam/record/sensor.h"

#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/strategies/strategy.h"

namespace slam::record {
namespace {

constexpr const char *kSection = "sensor", *kCamera = "camera", *kLidar = "lidar";
constexpr const char* kFirstLabel = "LASER";

bool isLidar(const std::string& section) {
  return section == kLidar || section.rfind("lidar ", 0) == 0;
}

/// "lidar rear" -> "rear"; "" for all other sections.
std::string lidarName(const std::string& section) {
  return isLidar(section) && section != kLidar ? files::trimmed(section.substr(6)) : "";
}

/// The rows of [lidar], from a section of another name too.
lidar::LidarOptions readLidar(const files::IniFile& config, const std::string& section,
                              const robot::RobotOptions& robot, std::vector<files::ParameterReport>* report) {
  files::IniFile own;
  if (const auto it = config.sections().find(section); it != config.sections().end())
    for (const auto& [key, entry] : it->second) own.set(kLidar, key, entry.value, entry.origin);
  lidar::LidarOptions lidar;
  std::vector<files::ParameterReport> lines;
  files::readParameters(own, lidar::LidarOptions::table(), lidar, &lines);
  for (auto& line : lines) line.section = section;
  if (report != nullptr) report->insert(report->end(), lines.begin(), lines.end());
  const double away_m = core::hypot(lidar.mount_x_m, lidar.mount_y_m);
  const double radius_m = robot::circumscribedRadius(robot);
  if (away_m > radius_m)
    throw core::InputError("section [" + section + "], keys 'mount_x_m' and 'mount_y_m': the lidar is " +
                           files::formatNumber(std::round(1e3 * away_m) / 1e3) +
                           " m from the robot's centre, expected on it: at most " +
                           files::formatNumber(std::round(1e3 * radius_m) / 1e3) + " m (robot.side_m)");
  return lidar;
}

/// Lidars in one place are one for whoever reads the log, as are those of one name.
void requireApart(const SensorConfig& sensor) {
  std::vector<const lidar::LidarOptions*> mounted = {&sensor.lidar};
  for (const auto& other : sensor.other_lidars) {
    const std::string section = "section [lidar " + other.label + "]: ";
    if (other.label == kFirstLabel || other.label.find(',') != std::string::npos)
      throw core::InputError(section + "found the name '" + other.label +
                             "', expected one without a comma, not " + kFirstLabel +
                             ", which is the first lidar's");
    for (const auto* lidar : mounted)
      if (lidar->mount_x_m == other.options.mount_x_m && lidar->mount_y_m == other.options.mount_y_m &&
          lidar->mount_yaw_rad == other.options.mount_yaw_rad)
        throw core::InputError(section +
                               "is mounted where another lidar is, expected a mount_x_m, mount_y_m or "
                               "mount_yaw_deg of its own");
    mounted.push_back(&other.options);
  }
}

}  // namespace

SensorOptions::SensorOptions() {
  table().setDefaults(*this);
}

const files::ParameterTable<SensorOptions>& SensorOptions::table() {
  using O = SensorOptions;
  static const files::ParameterTable<O> rows(
      kSection, {{"kind", &O::kind, "lidar", {"lidar", kCamera}, "what the robot looks with"}});
  return rows;
}

std::vector<std::string> sensorSections(const files::IniFile& config) {
  std::vector<std::string> sections = {kSection, "lidar", "camera", "camera_scan"};
  for (const auto& [section, entries] : config.sections())
    if (!lidarName(section).empty()) sections.push_back(section);
  return sections;
}

SensorConfig readSensor(const files::IniFile& config, const robot::RobotOptions& robot,
                        std::vector<files::ParameterReport>* report) {
  SensorOptions options;
  files::readParameters(config, SensorOptions::table(), options, report);
  const bool is_camera = options.kind == kCamera;
  for (const auto& section : sensorSections(config)) {
    const bool is_others = section != kSection && isLidar(section) == is_camera;
    if (is_others && config.hasSection(section))
      throw core::InputError("section [" + section + "]: has no effect with section [sensor], key 'kind': '" +
                             options.kind + "', expected " + (is_camera ? "lidar" : kCamera) + " there");
  }
  SensorConfig sensor;
  if (!is_camera) {
    sensor.lidar = readLidar(config, kLidar, robot, report);
    for (const auto& section : sensorSections(config))
      if (const std::string name = lidarName(section); !name.empty())
        sensor.other_lidars.push_back({name, readLidar(config, section, robot, report)});
    requireApart(sensor);
    return sensor;
  }
  sensor.camera.emplace();
  files::readParameters(config, robot::CameraOptions::table(), sensor.camera->view, report);
  files::readParameters(config, robot::CameraScanOptions::table(), sensor.camera->scan, report);
  robot::requireSensible(*sensor.camera);
  sensor.lidar = robot::asLidar(*sensor.camera);
  return sensor;
}

files::IniFile withCameraDefaults(const files::IniFile& config,
                                  const std::optional<robot::FloorCamera>& camera,
                                  const robot::RobotOptions& robot) {
  files::IniFile filled = config;
  if (!camera) return filled;
  const auto setDefault = [&](const char* section, const char* key, const std::string& value) {
    if (!config.find(section, key)) filled.set(section, key, value, "sensor.kind = camera");
  };
  setDefault("strategy", "memory", "local_map");
  setDefault("navigate", "memory", "local_map");
  // What the net of remembered points leaves out has to be less than the margin of 2 cm that motion keeps.
  setDefault("obstacles", "merge_distance_m", "0.02");
  setDefault("obstacles", "max_points", "3000");
  setDefault("strategy", "unseen", "looked_at");
  setDefault("navigate", "unseen", "looked_at");
  const double reach_m =
      robot::visibleFloor(camera->view).nearest_m + robot.max_speed_mps / camera->scan.rate_hz;
  if (reach_m > strategies::StrategyOptions().stop_clearance_m)
    setDefault("strategy", "stop_clearance_m", files::formatNumber(std::ceil(reach_m * 100) / 100));
  return filled;
}

std::pair<double, int> beamsOverFloor(const std::optional<robot::FloorCamera>& camera,
                                      const lidar::Scan& scan) {
  if (!camera) return {scan.first_angle_rad, static_cast<int>(scan.ranges_m.size())};
  const double half_rad = robot::wholeHalfAngle(*camera);
  return {-half_rad, 2 * static_cast<int>(std::lround(half_rad / scan.step_rad)) + 1};
}

}  // namespace slam::record
