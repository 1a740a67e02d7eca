// @name@ LOG OUTPUT: reads a log, writes the poses. @name@.ini starts it.
#include <exception>
#include <iostream>

#include "@name@.h"
#include "libslam/logs/trajectory_io.h"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: @name@ LOG OUTPUT\n";
    return 2;
  }
  slam::logs::LogReader log(argv[1]);
  @Name@ method;
  slam::core::Trajectory path;
  slam::core::Pose2 T_odom_before;
  while (const auto entry = log.next()) {
    path.push_back({entry->scan.time_s, method.update(entry->scan, slam::core::between(T_odom_before, entry->T_odom_robot))});
    T_odom_before = entry->T_odom_robot;
  }
  slam::logs::writeTum(path, argv[2]);
  return 0;
} catch (const std::exception& error) {
  std::cerr << "@name@: " << error.what() << "\n";
  return 1;
}
