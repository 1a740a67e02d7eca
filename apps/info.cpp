#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "libslam/logs/log_reader.h"
#include "libslam/run/compare.h"

namespace slam::apps {
namespace {

int showInfo(const Context& context, const std::string& path) {
  const auto info = logs::inspectLog(path);
  const std::string truth = run::findTruth(path);
  if (context.json) {
    std::cout << nlohmann::ordered_json{{"path", info.path},
                                        {"form", info.form},
                                        {"file_bytes", info.file_bytes},
                                        {"entries", info.entries},
                                        {"scans", info.scans},
                                        {"odometry_readings", info.odometry_readings},
                                        {"other_observations", info.other_observations},
                                        {"first_time_s", info.first_time_s},
                                        {"last_time_s", info.last_time_s},
                                        {"sensor_label", info.sensor_label},
                                        {"beams", info.beams},
                                        {"fov_deg", core::radToDeg(info.fov_rad)},
                                        {"step_deg", core::radToDeg(info.step_rad)},
                                        {"max_range_m", info.max_range_m},
                                        {"mount",
                                         {info.T_robot_lidar.x, info.T_robot_lidar.y,
                                          core::radToDeg(info.T_robot_lidar.phi)}},
                                        {"odometry_length_m", info.odometry_length_m},
                                        {"median_scan_period_s", info.median_scan_period_s},
                                        {"longest_gap_s", info.longest_gap_s},
                                        {"no_return_share", info.no_return_share},
                                        {"lost_share", info.lost_share},
                                        {"stamps_run_back", info.stamps_run_back},
                                        {"truth", truth}}
                     .dump(2)
              << "\n";
    return 0;
  }
  std::printf("file        %s (%.2f MB)\n", info.path.c_str(), static_cast<double>(info.file_bytes) / 1e6);
  std::printf("form        %s, %lu entries\n", info.form.c_str(), static_cast<unsigned long>(info.entries));
  std::printf("scans       %lu from \"%s\", %lu other observations\n", static_cast<unsigned long>(info.scans),
              info.sensor_label.c_str(), static_cast<unsigned long>(info.other_observations));
  if (info.scans > 0) {
    std::printf("lidar       %d beams over %.2f deg, step %.4f deg, range to %.1f m\n", info.beams,
                core::radToDeg(info.fov_rad), core::radToDeg(info.step_rad), info.max_range_m);
    std::printf("mounted at  x %.3f m, y %.3f m, yaw %.2f deg\n", info.T_robot_lidar.x, info.T_robot_lidar.y,
                core::radToDeg(info.T_robot_lidar.phi));
    std::printf("readings    %.1f %% no return, %.1f %% lost\n", 100 * info.no_return_share,
                100 * info.lost_share);
    std::printf("time        %.1f s from %.3f, a scan every %.3f s, longest gap %.3f s%s\n",
                info.last_time_s - info.first_time_s, info.first_time_s, info.median_scan_period_s,
                info.longest_gap_s, info.stamps_run_back ? ", stamps run back" : "");
  }
  std::printf("odometry    %lu readings, %.1f m\n", static_cast<unsigned long>(info.odometry_readings),
              info.odometry_length_m);
  std::printf("truth       %s\n", truth.empty() ? "none beside the log" : truth.c_str());
  return 0;
}

}  // namespace

void addInfo(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("info", "say what a log holds");
  auto path = std::make_shared<std::string>();
  command->add_option("log", *path, "a log: MRPT rawlog, CARMEN, ...")->required();
  addJson(command, context);
  command->footer("Example:\n  rasterslam info run.rawlog");
  command->callback(
      [&context, path] { context.action = [&context, path] { return showInfo(context, *path); }; });
}

}  // namespace slam::apps
