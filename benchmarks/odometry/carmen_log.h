#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/robot/scan.h"

namespace odometry_bench {

/// The pose of the robot at time `to_s` seen from `from_s`, as annotated by hand (Freiburg relations).
struct Relation {
  double from_s, to_s;
  slam::core::Pose2 T_from_to;
};

/// Scans and whatever is known of the true motion.
struct BenchLog {
  std::string name;
  std::vector<slam::robot::Scan> scans;
  slam::core::Trajectory truth;  ///< of the robot, one pose per scan, or empty
  std::vector<Relation> relations;
  std::vector<slam::core::Pose2> wheels;  ///< wheel odometry, one pose per scan: only to say how far it drove
};

/// What a CARMEN log does not say.
struct CarmenFormat {
  double first_angle_rad = 0, step_rad = 0;  ///< of FLASER lines; ROBOTLASER1 lines carry their own
  double no_return_m = 80;                   ///< readings of at least this are no-returns
  double lidar_x_m = 0;                      ///< mounting
  double sigma_m = 0.01;
};

/// Reads scans and wheel odometry of FLASER and ROBOTLASER1 lines in file order, at most `most_scans`, through
/// `unpack` (bzcat or xzcat). InputError on a line that is shorter than its own count of readings, or when
/// nothing came.
void readCarmen(const std::string& unpack, const std::string& path, const CarmenFormat& format,
                size_t most_scans, BenchLog& log);
/// `t1 t2 x y z roll pitch yaw` per line.
std::vector<Relation> readRelations(const std::string& path);
/// TUM: `t x y z qx qy qz qw` per line.
slam::core::Trajectory readTum(const std::string& path);

}  // namespace odometry_bench
