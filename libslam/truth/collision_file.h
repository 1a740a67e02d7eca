#pragma once
#include <string>
#include <vector>

#include "libslam/sim/simulator.h"

namespace slam::truth {

/// STEM.collisions.csv beside a recording, when there was any: time_s,x_m,y_m,heading_rad (world frame).
std::string collisionsCsv(const std::vector<sim::Collision>& collisions);
/// Of a log or of its truth: "a/run.gt.tum" -> "a/run.collisions.csv".
std::string collisionsPath(const std::string& log_or_truth_path);
/// Reads it back; none where there is no such file. Errors: InputError with file and line.
std::vector<sim::Collision> readCollisions(const std::string& path);

}  // namespace slam::truth
