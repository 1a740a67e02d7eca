#include "libslam/truth/collision_file.h"

#include <cstdio>

#include "libslam/truth/number_rows.h"
#include "libslam/truth/truth_files.h"

namespace slam::truth {
namespace {

constexpr const char* kCollisionsHeader = "time_s,x_m,y_m,heading_rad";

}  // namespace

std::string collisionsCsv(const std::vector<sim::Collision>& collisions) {
  std::string text = std::string(kCollisionsHeader) + "\n";
  for (const auto& collision : collisions) {
    char line[200];
    const auto& pose = collision.T_world_robot;
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.3f,%.4f\n", collision.time_s, pose.x, pose.y, pose.phi);
    text += line;
  }
  return text;
}

std::string collisionsPath(const std::string& log_or_truth_path) {
  return besideLog(log_or_truth_path, ".collisions.csv");
}

std::vector<sim::Collision> readCollisions(const std::string& path) {
  std::vector<sim::Collision> collisions;
  for (const auto& row : readNumberRows(path, kCollisionsHeader))
    collisions.push_back({row[0], {row[1], row[2], row[3]}});
  return collisions;
}

}  // namespace slam::truth
