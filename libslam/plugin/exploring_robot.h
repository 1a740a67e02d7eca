#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "libslam/files/ini.h"
#include "libslam/record/record.h"

namespace slam::plugin {

/// What MRPT's .ini says of a simulated robot besides MRPT's own keys.
struct ExploringRobotOptions {
  std::string plan;      ///< path, or the name of a committed world
  std::string lidar;     ///< name of a preset in configs/lidars, or an .ini file; empty: built-in values
  std::string strategy;  ///< empty: the built-in one
  std::string slam;      ///< method of configs/methods, or an .ini file; used where the strategy needs a map
  std::string start;     ///< "auto", or "x_m y_m yaw_deg"
  int seed;              ///< of every random stream
  int scans;             ///< after so many it is silent; 0 = no end
  double real_time_factor;  ///< simulated seconds per second; 0 = one scan per call at MRPT's process_rate
  std::string done_file;    ///< gets one line (a named pipe too) when the last scan was taken; empty: none

  record::RecordConfig record;  ///< all else
};

/// Reads section `section` of `ini`. A key with a dot goes through to the simulation: `robot.side_m = 0.3` is
/// key side_m of its section [robot]; such keys win over the preset and the short ones. Strict: errors as
/// files::readParameters and record::readRecordConfig (InputError).
ExploringRobotOptions readExploringRobotOptions(const files::IniFile& ini, const std::string& section);

/// A robot that explores a plan on its own in simulated time: what record::record() does, one scan at a time,
/// so that the same plan, options and seed give the same scans and odometry as a rawlog of
/// `rasterslam simulate`. A strategy that needs a map gets that of `slam`, made of the robot's own scans and
/// odometry as in explore::explore(), with the pose in it; the truth only moves the robot and draws its
/// scans.
class ExploringRobot {
 public:
  /// Errors: no such plan, no free start, no such method (InputError).
  explicit ExploringRobot(const ExploringRobotOptions& options);
  ~ExploringRobot();
  /// Drives on for one scan period and looks (the first call only looks). nullopt after `scans` scans, and
  /// when the strategy has nothing left to explore. Errors: the method diverged (MethodError).
  std::optional<sim::Sensed> next();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::plugin
