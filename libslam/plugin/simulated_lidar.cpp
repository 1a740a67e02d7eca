#include "libslam/plugin/simulated_lidar.h"

#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/math/TPose2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/poses/CPose2D.h>

#include <algorithm>
#include <fstream>
#include <set>

#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/plugin/exploring_robot.h"

namespace slam::plugin {
namespace {

/// Read by MRPT itself, for every sensor.
const std::set<std::string> kMrptKeys = {"driver",          "process_rate", "max_queue_len",
                                         "grab_decimation", "sensorLabel",  "rawlog-grabber-ignore"};

/// The keys that are ours. MRPT leaves a comment behind a text in the value; our own grammar takes it off.
files::IniFile ownKeys(const mrpt::config::CConfigFileBase& source, const std::string& section) {
  files::IniFile ini;
  std::vector<std::string> keys;
  source.getAllKeys(section, keys);
  for (const auto& key : keys) {
    if (kMrptKeys.count(key)) continue;
    const std::string line = key + " = " + source.read_string(section, key, "");
    const std::string origin = "rawlog-grabber's configuration";
    const auto parsed = files::IniFile::parse("[" + section + "]\n" + line, origin);
    ini.set(section, key, parsed.find(section, key)->value, origin);
  }
  return ini;
}

/// MRPT takes what stands before a ']' in an error for a place in its code, and tears our line apart.
[[noreturn]] void rethrowForMrpt(const core::InputError& error) {
  std::string line = error.what();
  line.erase(std::remove_if(line.begin(), line.end(), [](char c) { return c == '[' || c == ']'; }),
             line.end());
  throw core::InputError(line);
}

}  // namespace

class SimulatedLidar : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(SimulatedLidar)

 public:
  void initialize() override {
    try {
      robot_ = std::make_unique<ExploringRobot>(options_);
    } catch (const core::InputError& error) {
      rethrowForMrpt(error);
    }
    m_state = ssWorking;
  }

  void doProcess() override {
    if (const auto sensed = robot_->next())
      appendObservations({odometryOf(*sensed), scanOf(*sensed)});
    else
      sayDone();
  }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& source,
                                 const std::string& section) override {
    try {
      options_ = readExploringRobotOptions(ownKeys(source, section), section);
    } catch (const core::InputError& error) {
      rethrowForMrpt(error);
    }
    if (options_.real_time_factor > 0)
      m_process_rate = options_.real_time_factor * options_.record.lidar.rate_hz;
  }

 private:
  static mrpt::Clock::time_point stampOf(const sim::Sensed& sensed) {
    return mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicks(sensed.scan.time_s)));
  }

  static mrpt::obs::CObservationOdometry::Ptr odometryOf(const sim::Sensed& sensed) {
    auto odometry = mrpt::obs::CObservationOdometry::Create();
    odometry->sensorLabel = "ODOMETRY";
    odometry->timestamp = stampOf(sensed);
    odometry->odometry = mrpt::poses::CPose2D(lidar::toMrpt(sensed.T_odom_robot));
    return odometry;
  }

  mrpt::obs::CObservation2DRangeScan::Ptr scanOf(const sim::Sensed& sensed) const {
    auto scan = lidar::toMrpt(sensed.scan);
    scan->sensorLabel = m_sensorLabel;
    scan->timestamp = stampOf(sensed);
    return scan;
  }

  /// Only in the call after the last scan, when whoever called has fetched it.
  void sayDone() {
    if (said_done_) return;
    said_done_ = true;
    if (options_.done_file.empty()) return;
    std::ofstream out(options_.done_file);
    out << "done\n";
    out.close();
    if (!out) throw core::IoError(options_.done_file + ": cannot be written");
  }

  ExploringRobotOptions options_;
  std::unique_ptr<ExploringRobot> robot_;
  bool said_done_ = false;
};

IMPLEMENTS_GENERIC_SENSOR(SimulatedLidar, slam::plugin)

void registerSensors() {
  SimulatedLidar::doRegister();
}

}  // namespace slam::plugin
