#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "libslam/lidar/scan.h"

namespace slam::fuzz {

/// A drive told by bytes, for whoever changes them with a purpose: the first ones say which lidar it is, and
/// then four of each step what it sees, when, and how the wheels turn. No byte is refused.
class ScanScript {
 public:
  struct Step {
    lidar::Scan scan;
    core::Pose2 T_previous_robot;
    bool has_odometry;
  };

  /// leap_m: how far odometry leaps at most, 128 times over.
  ScanScript(const std::uint8_t* data, std::size_t size, double leap_m)
      : at_(data), end_(data + size), leap_m_(leap_m) {
    lidar_.time_s = 1000;
    lidar_.ranges_m.resize(2 + std::size_t{next()} / 4);  // few, for many drives
    const double fov_rad = (next() + 1) / 256.0 * 2 * core::kPi;
    lidar_.step_rad = fov_rad / static_cast<double>(lidar_.ranges_m.size());
    lidar_.first_angle_rad = next() / 128.0 * core::kPi - core::kPi;
    lidar_.max_range_m = std::exp2(next() / 32.0);
    lidar_.range_sigma_m = 0.01;
  }

  /// While there are bytes left for a whole one.
  std::optional<Step> step() {
    if (end_ - at_ < 4) return std::nullopt;
    const std::uint8_t look = next(), detail = next();
    const int along = static_cast<std::int8_t>(next()), turn = static_cast<std::int8_t>(next());
    lidar_.time_s += look & 8 ? 3 : 0.1;
    if ((look & 7) != 7) see(look & 7, (detail + 1) / 256.0 * lidar_.max_range_m);
    if (look & 16) spoil(detail);
    if (look & 32) lidar_.T_robot_lidar = {detail / 256.0, -0.1, turn / 40.0};  // another lidar of the robot
    // Metres by 1/128; now and then a leap.
    const double scale = look & 64 ? leap_m_ : 1 / 128.0;
    return Step{lidar_, {scale * along, 0, turn / 40.0}, (look & 128) == 0};
  }

 private:
  std::uint8_t next() { return at_ < end_ ? *at_++ : 0; }

  void see(int what, double at_m) {
    for (std::size_t i = 0; i < lidar_.ranges_m.size(); ++i) {
      const double c = std::cos(lidar_.angle(i)), s = std::sin(lidar_.angle(i));
      double range_m = at_m;                                                      // 0: a circle
      if (what == 1) range_m = at_m / c;                                          // a wall ahead
      if (what == 2) range_m = at_m / std::max(std::abs(s), 1e-9);                // a corridor
      if (what == 3) range_m = at_m / std::max(std::abs(s), std::abs(c));         // a room
      if (what == 4) range_m = at_m / std::max({s, 0.7 * c, -0.4 * s, -2 * c});   // the same from aside
      if (what == 5) range_m = at_m * static_cast<double>(i * i * 31 % 17) / 17;  // rubbish
      if (what == 6) range_m = lidar_.max_range_m * 2;                            // nothing
      const bool is_return = range_m > 0 && range_m < lidar_.max_range_m;
      lidar_.ranges_m[i] = is_return ? static_cast<float>(range_m) : lidar::kNoReturn;
    }
  }

  void spoil(std::uint8_t how) {
    const float bad[] = {lidar::kLostReading, -1,  0, 1e-30F, 3e38F, -lidar::kNoReturn,
                         lidar::kNoReturn,    1e6F};
    for (std::size_t i = how % 5U; i < lidar_.ranges_m.size(); i += 2 + how % 7U)
      lidar_.ranges_m[i] = bad[how % 8U];
  }

  const std::uint8_t *at_, *end_;
  double leap_m_;
  lidar::Scan lidar_;
};

}  // namespace slam::fuzz
