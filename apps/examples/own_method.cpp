// A method of your own, run by the benchmark beside one of ours.
//   own_method                   compares it with `naive_wheel` on a simulated log
//   own_method LOG PATH SEED     is the method: reads a log, writes the poses. Any program may do this, in
//                                any language.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "libslam/logs/log_reader.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"

namespace {

/// Dead reckoning by scans: what you would replace.
int estimate(const std::string& log_path, const std::string& output) {
  slam::odometry::ScanOdometryOptions options;
  options.method = "plicp";
  const auto odometry = slam::odometry::makeScanOdometry(options);
  slam::logs::LogReader log(log_path);
  slam::core::Trajectory path;
  slam::core::Pose2 T_map_robot;
  while (const auto entry = log.next()) {
    T_map_robot = T_map_robot * odometry->update(entry->scan).T_previous_current;
    path.push_back({entry->scan.time_s, T_map_robot});
  }
  slam::logs::writeTum(path, output);
  return 0;
}

int benchmark(const std::string& program) {
  std::ofstream("own.ini") << "[method]\ntype = external\ncommand = " << program
                           << " {log} {output} {seed}\n";
  slam::files::IniFile settings;
  settings.setFromArgument("simulation.duration_s=20", "settings");
  slam::score::CompareRequest request;
  request.plan_path = slam::resources::resolvePlan("flat");
  request.record = slam::record::readRecordConfig(settings);
  request.methods = {"naive_wheel", "./own.ini"};
  request.methods_folder = slam::resources::configsFolder() + "/methods";
  request.output = "own";
  const auto comparison = slam::score::compare(request, {}, slam::core::silentProgress());
  std::cout << slam::table::toText(comparison.accuracy);
  return comparison.failed;
}

}  // namespace

int main(int argc, char** argv) try {
  return argc == 4 ? estimate(argv[1], argv[2])
                   : benchmark(std::filesystem::read_symlink("/proc/self/exe").string());
} catch (const std::exception& error) {
  std::cerr << "own_method: " << error.what() << "\n";
  return 1;
}
