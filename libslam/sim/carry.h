#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

namespace slam::sim {

/// Section [events]: what is done to the robot from outside, while it works.
struct EventOptions {
  std::string carry;  ///< the kidnapped robot: see parseCarries()
  EventOptions();
  static const files::ParameterTable<EventOptions>& table();
};

/// The kidnapped robot: at a moment somebody lifts the robot up and puts it down elsewhere. Its wheels do not
/// turn and nobody tells it.
struct CarryOrder {
  double time_s = 0;          ///< since the first scan
  core::Pose2 T_world_robot;  ///< where it is put down, with kGiven
  std::string origin;         ///< for errors: "--carry"
  enum class Where { kGiven, kRandom, kVisited } where = Where::kGiven;
};

/// A kidnapped robot: put elsewhere without its wheels noticing.
struct Carry {
  double time_s;  ///< as Simulator::time_s() counts
  core::Pose2 T_world_from, T_world_to;
};

/// Reads "TIME_S:X_M,Y_M,HEADING_DEG", "TIME_S:random" (any place that it could drive to) or "TIME_S:visited"
/// (a place that it has been at), several separated by blanks, in any order; world frame, times since the
/// first scan. "none": none. The result is sorted by time. `origin` stands before errors. Errors: InputError
/// for another form, a time that is not above 0, two at one time.
std::vector<CarryOrder> parseCarries(const std::string& text, const std::string& origin);

/// Section [events] of a configuration; its parameters are appended to `report`. Errors: InputError.
std::vector<CarryOrder> readCarries(const files::IniFile& config,
                                    std::vector<files::ParameterReport>* report);

/// Refuses orders that come at the end or later, which are never carried out. Errors: InputError.
void requireBefore(const std::vector<CarryOrder>& carries, double end_s);

/// Adds up the way that a robot drives itself: what it is carried does not count.
class DrivenPath {
 public:
  /// The robot is now at T_world_robot; `carries`: all so far, in their order. The first call begins the
  /// path.
  void add(const core::Pose2& T_world_robot, const std::vector<Carry>& carries);
  double length_m() const { return length_m_; }

 private:
  bool has_begun_ = false;
  core::Pose2 T_world_last_;
  std::size_t carries_ = 0;
  double length_m_ = 0;
};

}  // namespace slam::sim
