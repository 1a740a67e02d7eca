#pragma once
#include <string>
#include <vector>

#include "libslam/sim/carry.h"

namespace slam::truth {

/// STEM.carries.csv beside a recording in which the robot was kidnapped:
///   time_s,from_x_m,from_y_m,from_heading_rad,to_x_m,to_y_m,to_heading_rad   (world frame, true)
std::string carriesCsv(const std::vector<sim::Carry>& carries);
/// Of a log or of its truth: "a/run.gt.tum" -> "a/run.carries.csv".
std::string carriesPath(const std::string& log_or_truth_path);
/// Reads it back; none where there is no such file. Errors: InputError with file and line.
std::vector<sim::Carry> readCarryFile(const std::string& path);

/// A true path for a picture: a pose that is not finite stands where the robot was kidnapped, so that no line
/// is drawn there.
core::Trajectory brokenAtCarries(const core::Trajectory& truth, const std::vector<sim::Carry>& carries);

/// For people: "kidnapped at 60.0 s from (1.00 m, 2.00 m) to (12.50 m, 3.00 m, 90 deg)". start_s: of the
/// first scan.
std::string carryText(const sim::Carry& carry, double start_s);

}  // namespace slam::truth
