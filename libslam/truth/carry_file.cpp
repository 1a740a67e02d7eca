#include "libslam/truth/carry_file.h"

#include <cstdio>

#include "libslam/core/numbers.h"
#include "libslam/truth/number_rows.h"
#include "libslam/truth/truth_files.h"

namespace slam::truth {
namespace {

constexpr const char* kHeader = "time_s,from_x_m,from_y_m,from_heading_rad,to_x_m,to_y_m,to_heading_rad";

}  // namespace

std::string carriesCsv(const std::vector<sim::Carry>& carries) {
  std::string text = std::string(kHeader) + "\n";
  for (const auto& [time_s, from, to] : carries) {
    char line[200];
    std::snprintf(line, sizeof line, "%.3f,%.3f,%.3f,%.4f,%.3f,%.3f,%.4f\n", time_s, from.x, from.y, from.phi,
                  to.x, to.y, to.phi);
    text += line;
  }
  return text;
}

std::string carriesPath(const std::string& log_or_truth_path) {
  return besideLog(log_or_truth_path, ".carries.csv");
}

std::vector<sim::Carry> readCarryFile(const std::string& path) {
  std::vector<sim::Carry> carries;
  for (const auto& row : readNumberRows(path, kHeader))
    carries.push_back({row[0], {row[1], row[2], row[3]}, {row[4], row[5], row[6]}});
  return carries;
}

core::Trajectory brokenAtCarries(const core::Trajectory& truth, const std::vector<sim::Carry>& carries) {
  using core::kNaN;
  core::Trajectory path;
  auto carry = carries.begin();
  for (const auto& pose : truth) {
    for (; carry != carries.end() && carry->time_s <= pose.time_s; ++carry)
      if (!path.empty()) path.push_back({carry->time_s, {kNaN, kNaN, 0}});
    path.push_back(pose);
  }
  return path;
}

std::string carryText(const sim::Carry& carry, double start_s) {
  char text[160];
  std::snprintf(text, sizeof text, "kidnapped at %.1f s from (%.2f m, %.2f m) to (%.2f m, %.2f m, %.0f deg)",
                carry.time_s - start_s, carry.T_world_from.x, carry.T_world_from.y, carry.T_world_to.x,
                carry.T_world_to.y, core::radToDeg(carry.T_world_to.phi));
  return text;
}

}  // namespace slam::truth
