#include <array>
#include <optional>
#include <string>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/rawlogs/carmen_log.h"
#include "libslam/rawlogs/carmen_words.h"

namespace slam::rawlogs {
namespace {

// CARMEN's reader of logs: carmen_laser_laser_message.maximum_range of lines that do not say.
constexpr double kDefaultMaxRange_m = 80;
constexpr double kLargestNumber = 1e6;  // of a range, in metres: far beyond any sensor, within a float

/// Readings of a sweep that spans so many degrees, of the scanners that are known by this number.
struct KnownSweep {
  size_t steps;
  double span_deg;
};
constexpr std::array<KnownSweep, 8> kKnownSweeps = {
    {{180, 180}, {360, 180}, {400, 100}, {200, 100}, {100, 100}, {540, 270}, {1080, 270}, {720, 180}}};
constexpr double kOtherSpan_deg = 180;

}  // namespace

void CarmenSettings::take(std::string_view name, std::string_view value) {
  struct Row {
    std::string_view name;
    std::optional<double> Laser::*member;
    Laser CarmenSettings::*laser;
    double lowest, highest;
  };
  constexpr double kTiny = 1e-3;
  static const std::array<Row, 8> kRows = {{
      {"robot_frontlaser_offset", &Laser::offset_m, &CarmenSettings::front_, -100, 100},
      {"robot_rearlaser_offset", &Laser::offset_m, &CarmenSettings::rear_, -100, 100},
      {"robot_front_laser_max", &Laser::max_range_m, &CarmenSettings::front_, kTiny, kLargestNumber},
      {"robot_rear_laser_max", &Laser::max_range_m, &CarmenSettings::rear_, kTiny, kLargestNumber},
      {"laser_front_laser_resolution", &Laser::step_deg, &CarmenSettings::front_, kTiny, 180},
      {"laser_rear_laser_resolution", &Laser::step_deg, &CarmenSettings::rear_, kTiny, 180},
      {"laser_front_laser_fov", &Laser::fov_deg, &CarmenSettings::front_, kTiny, 360},
      {"laser_rear_laser_fov", &Laser::fov_deg, &CarmenSettings::rear_, kTiny, 360},
  }};
  for (const Row& row : kRows) {
    if (row.name != name) continue;
    double number = 0;
    if (!parse(value, number) || number < row.lowest || number > row.highest)
      throw core::InputError("parameter " + std::string(name) + ": found " + quoted(value) +
                             ", expected a number from " + files::formatNumber(row.lowest) + " to " +
                             files::formatNumber(row.highest));
    (this->*row.laser).*row.member = number;
  }
}

CarmenSettings::Geometry CarmenSettings::geometry(size_t readings, bool is_rear,
                                                  const core::Pose2& T_odom_robot,
                                                  const core::Pose2& T_odom_laser) const {
  const Laser& laser = is_rear ? rear_ : front_;
  // The whole sweep has an odd number of readings; an even one lacks the last.
  const size_t steps = readings - readings % 2;
  double span_deg = kOtherSpan_deg;
  for (const auto& known : kKnownSweeps)
    if (known.steps == steps) span_deg = known.span_deg;
  if (laser.step_deg && *laser.step_deg * static_cast<double>(steps) <= 360 + 1e-6)
    span_deg = *laser.step_deg * static_cast<double>(steps);
  Geometry geometry;
  geometry.step_rad = core::degToRad(span_deg / static_cast<double>(steps));
  geometry.first_angle_rad = core::degToRad(-laser.fov_deg.value_or(span_deg) / 2);
  geometry.max_range_m = laser.max_range_m.value_or(kDefaultMaxRange_m);
  geometry.T_robot_lidar.x = laser.offset_m.value_or(0);
  if (!is_rear) return geometry;
  const double shown_x_m = core::between(T_odom_robot, T_odom_laser).x;
  if (shown_x_m * geometry.T_robot_lidar.x < 0) geometry.T_robot_lidar.x *= -1;
  geometry.T_robot_lidar.phi = core::kPi;
  return geometry;
}

void CarmenSettings::takeLine(std::string_view line) {
  CarmenWords words(line);
  if (words.next() != "PARAM") return;
  const auto name = words.word("a parameter's name"), value = words.next();
  take(name, value);
}

}  // namespace slam::rawlogs
