#include "benchmarks/odometry/carmen_log.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>

#include "libslam/core/error.h"

namespace odometry_bench {
namespace {

using slam::core::InputError;
using slam::core::Pose2;
using slam::robot::Scan;

/// Numbers and words of one line, in order.
class Words {
 public:
  Words(const std::string& line, std::string where) : stream_(line), where_(std::move(where)) {}
  std::string word() {
    std::string text;
    if (!(stream_ >> text)) throw InputError(where_ + ": found the end of the line, expected more fields");
    return text;
  }
  double number() {
    const std::string text = word();
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (*end != 0) throw InputError(where_ + ": found '" + text + "', expected a number");
    return value;
  }
  void skip(int count) {
    for (int i = 0; i < count; ++i) word();
  }

 private:
  std::istringstream stream_;
  std::string where_;
};

void readRanges(Words& words, size_t count, double no_return_m, Scan& scan) {
  scan.ranges_m.resize(count);
  for (float& range : scan.ranges_m) {
    const double reading = words.number();
    range = reading >= no_return_m ? slam::robot::kNoReturn : static_cast<float>(reading);
    if (reading <= 0) range = slam::robot::kLostReading;
  }
}

Pose2 readPose(Words& words) {
  const double x = words.number(), y = words.number();
  return {x, y, words.number()};
}

Scan readFlaser(Words& words, const CarmenFormat& format, Pose2& wheels) {
  Scan scan;
  scan.first_angle_rad = format.first_angle_rad;
  scan.step_rad = format.step_rad;
  scan.max_range_m = format.no_return_m;
  scan.range_sigma_m = format.sigma_m;
  scan.T_robot_lidar.x = format.lidar_x_m;
  readRanges(words, static_cast<size_t>(words.number()), format.no_return_m, scan);
  readPose(words);  // of the laser
  wheels = readPose(words);
  scan.time_s = words.number();
  return scan;
}

Scan readRobotLaser(Words& words, Pose2& wheels) {
  Scan scan;
  words.skip(1);  // laser type
  scan.first_angle_rad = words.number();
  words.skip(1);  // field of view
  scan.step_rad = words.number();
  scan.max_range_m = words.number();
  scan.range_sigma_m = words.number();
  words.skip(1);  // remission mode
  readRanges(words, static_cast<size_t>(words.number()), scan.max_range_m + 1e-6, scan);
  words.skip(static_cast<int>(words.number()));  // remissions
  readPose(words);                               // of the laser
  wheels = readPose(words);
  words.skip(5);  // speeds and safety distances
  scan.time_s = words.number();
  return scan;
}

}  // namespace

void readCarmen(const std::string& unpack, const std::string& path, const CarmenFormat& format,
                size_t most_scans, BenchLog& log) {
  const std::string command = unpack + " '" + path + "'";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  if (!pipe) throw InputError("cannot run " + command);
  std::string line;
  size_t number = 0;
  for (int c = 0; log.scans.size() < most_scans && c != EOF;) {
    line.clear();
    while ((c = std::fgetc(pipe.get())) != EOF && c != '\n') line += static_cast<char>(c);
    ++number;
    if (line.rfind("FLASER ", 0) != 0 && line.rfind("ROBOTLASER1 ", 0) != 0) continue;
    Words words(line, path + ", line " + std::to_string(number));
    Pose2 wheels;
    log.scans.push_back(words.word() == "FLASER" ? readFlaser(words, format, wheels)
                                                 : readRobotLaser(words, wheels));
    log.wheels.push_back(wheels);
  }
  if (log.scans.empty()) throw InputError(path + ": no scans");
}

std::vector<Relation> readRelations(const std::string& path) {
  std::ifstream file(path);
  std::vector<Relation> relations;
  double from, to, x, y, z, roll, pitch, yaw;
  while (file >> from >> to >> x >> y >> z >> roll >> pitch >> yaw)
    relations.push_back({from, to, {x, y, yaw}});
  if (relations.empty()) throw InputError(path + ": no relations");
  return relations;
}

slam::core::Trajectory readTum(const std::string& path) {
  std::ifstream file(path);
  slam::core::Trajectory trajectory;
  double t, x, y, z, qx, qy, qz, qw;
  while (file >> t >> x >> y >> z >> qx >> qy >> qz >> qw)
    trajectory.push_back({t, {x, y, 2 * std::atan2(qz, qw)}});
  if (trajectory.empty()) throw InputError(path + ": no poses");
  return trajectory;
}

}  // namespace odometry_bench
