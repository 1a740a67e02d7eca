#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/doctor/log_check.h"
#include "libslam/logs/log_reader.h"
#include "libslam/score/compare.h"
#include "libslam/truth/truth_files.h"

namespace slam::apps {
namespace {

nlohmann::ordered_json toJson(const std::vector<calibration::StreamFigures>& streams) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& stream : streams) {
    const bool has_rate = stream.mean_period_s > 0;
    list.push_back({{"kind", stream.kind},
                    {"label", stream.label},
                    {"count", stream.count},
                    {"rate_hz", has_rate ? nlohmann::ordered_json(1 / stream.mean_period_s) : nullptr},
                    {"first_s", stream.first_s},
                    {"last_s", stream.last_s}});
  }
  return list;
}

nlohmann::ordered_json toJson(const logs::LogInfo& info,
                              const std::vector<calibration::StreamFigures>& streams,
                              const std::string& truth) {
  return nlohmann::ordered_json{
      {"path", info.path},
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
      {"mount", {info.T_robot_lidar.x, info.T_robot_lidar.y, core::radToDeg(info.T_robot_lidar.phi)}},
      {"odometry_length_m", info.odometry_length_m},
      {"median_scan_period_s", info.median_scan_period_s},
      {"longest_gap_s", info.longest_gap_s},
      {"no_return_share", info.no_return_share},
      {"lost_share", info.lost_share},
      {"remarks", info.remarks},
      {"stamps_run_back", info.stamps_run_back},
      {"truth", truth},
      {"streams", toJson(streams)}};
}

template <class... Values>
void line(const std::string& heading, const char* form, Values... values) {
  const int size = std::snprintf(nullptr, 0, form, values...);
  std::string text(static_cast<std::size_t>(size), '\0');
  std::snprintf(text.data(), text.size() + 1, form, values...);
  printWrapped(padded(heading, 12), text);
}

unsigned long count(std::uint64_t number) {
  return static_cast<unsigned long>(number);
}

void printScans(const logs::LogInfo& info) {
  line("lidar", "%d beams over %.2f deg, step %.4f deg, range to %.1f m", info.beams,
       core::radToDeg(info.fov_rad), core::radToDeg(info.step_rad), info.max_range_m);
  line("mounted at", "x %.3f m, y %.3f m, yaw %.2f deg", info.T_robot_lidar.x, info.T_robot_lidar.y,
       core::radToDeg(info.T_robot_lidar.phi));
  line("readings", "%.1f %% no return, %.1f %% lost", 100 * info.no_return_share, 100 * info.lost_share);
  for (const auto& remark : info.remarks) line("remark", "%s", remark.c_str());
  line("time", "%.1f s from %.3f, a scan every %.3f s, longest gap %.3f s%s",
       info.last_time_s - info.first_time_s, info.first_time_s, info.median_scan_period_s, info.longest_gap_s,
       info.stamps_run_back ? ", stamps run back" : "");
}

void printStream(const calibration::StreamFigures& stream) {
  std::string rate;
  if (stream.mean_period_s > 0) {
    char text[40];
    std::snprintf(text, sizeof text, ", %.2f Hz", 1 / stream.mean_period_s);
    rate = text;
  }
  line("stream", "%s '%s': %lu%s", stream.kind.c_str(), stream.label.c_str(), count(stream.count),
       rate.c_str());
}

int showInfo(const Context& context, const std::string& path) {
  const auto info = logs::inspectLog(path);
  const auto streams = doctor::streamsOf(path);
  const std::string truth = truth::findTruth(path);
  if (context.json) {
    std::cout << toJson(info, streams, truth).dump(2) << "\n";
    return 0;
  }
  line("file", "%s (%.2f MB)", info.path.c_str(), static_cast<double>(info.file_bytes) / 1e6);
  line("form", "%s, %lu entries", info.form.c_str(), count(info.entries));
  line("scans", "%lu from \"%s\", %lu other observations", count(info.scans), info.sensor_label.c_str(),
       count(info.other_observations));
  if (info.scans > 0) printScans(info);
  line("odometry", "%lu readings, %.1f m", count(info.odometry_readings), info.odometry_length_m);
  for (const auto& stream : streams) printStream(stream);
  line("truth", "%s", truth.empty() ? "none beside the log" : truth.c_str());
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
