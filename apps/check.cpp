#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/quiet.h"
#include "libslam/core/error.h"
#include "libslam/doctor/log_check.h"

namespace slam::apps {
namespace {
using nlohmann::ordered_json;

struct CheckArguments {
  std::string log, lidar;
};

ordered_json toJson(const calibration::Estimate& estimate, double factor = 1) {
  return {
      {"value", estimate.value * factor}, {"low", estimate.low * factor}, {"high", estimate.high * factor}};
}

ordered_json toJson(const calibration::StreamFigures& stream) {
  auto gaps = ordered_json::array();
  for (const auto& gap : stream.gaps) gaps.push_back({{"from_s", gap.from_s}, {"length_s", gap.length_s}});
  return {{"kind", stream.kind},
          {"label", stream.label},
          {"count", stream.count},
          {"first_s", stream.first_s},
          {"last_s", stream.last_s},
          {"median_period_s", stream.median_period_s},
          {"mean_period_s", stream.mean_period_s},
          {"unstamped", stream.unstamped},
          {"backward", stream.backward},
          {"largest_backward_s", stream.largest_backward_s},
          {"repeated", stream.repeated},
          {"gaps", gaps}};
}

ordered_json rangesJson(const calibration::RangeFigures& r) {
  ordered_json json = {{"scans", r.scans},
                       {"beams", r.beams},
                       {"fov_deg", core::radToDeg(r.aperture_rad)},
                       {"max_range_m", r.max_range_m},
                       {"mount", {r.T_robot_lidar.x, r.T_robot_lidar.y, core::radToDeg(r.T_robot_lidar.phi)}},
                       {"geometry_changes", r.geometry_changes},
                       {"readings", r.readings},
                       {"returns", r.returns},
                       {"no_returns", r.no_returns},
                       {"zeros", r.zeros},
                       {"not_finite", r.not_finite},
                       {"other_invalid", r.other_invalid},
                       {"median_m", r.median_m},
                       {"largest_m", r.largest_m},
                       {"duplicates", r.duplicates},
                       {"dead_beams", r.dead_beams},
                       {"silent_beams", r.silent_beams},
                       {"stuck_beams", r.stuck_beams},
                       {"no_return_value", nullptr}};
  if (const auto& spike = r.spike)
    json["no_return_value"] = {{"peak_m", spike->peak_m},
                               {"low_m", spike->low_m},
                               {"high_m", spike->high_m},
                               {"readings", spike->readings},
                               {"as_returns", spike->as_returns}};
  return json;
}

ordered_json odometryJson(const doctor::LogFigures& f) {
  auto list = ordered_json::array();
  for (const auto& o : f.odometry)
    list.push_back({{"stream", o.stream},
                    {"readings", o.readings},
                    {"path_m", o.path_m},
                    {"turned_rad", o.turned_rad},
                    {"jumps", o.jumps},
                    {"clock_offset_s", o.clock.is_observable ? toJson(o.clock.offset_s) : ordered_json()},
                    {"turn_correlation", o.clock.correlation}});
  return list;
}

ordered_json fitJson(const calibration::OdometryFit& fit) {
  const auto when = [](bool known, const calibration::Estimate& estimate, double factor = 1) {
    return known ? toJson(estimate, factor) : ordered_json();
  };
  const double deg = core::radToDeg(1);
  return {{"pieces", fit.windows},
          {"distance_scale", when(fit.has_path, fit.distance_scale)},
          {"turn_scale", when(fit.has_turns, fit.turn_scale)},
          {"drift_deg_per_m", when(fit.has_path, fit.drift_rad_per_m, deg)},
          {"lidar_x_m", when(fit.has_position, fit.lidar_x_m)},
          {"lidar_y_m", when(fit.has_position, fit.lidar_y_m)},
          {"lidar_yaw_deg", when(fit.has_path, fit.lidar_yaw_rad, deg)}};
}

ordered_json toJson(const doctor::LogCheck& check) {
  const auto& f = check.figures;
  auto findings = ordered_json::array();
  for (const auto& finding : check.findings)
    findings.push_back({{"key", finding.key},
                        {"severity", doctor::severityName(finding.severity)},
                        {"text", finding.text},
                        {"advice", finding.advice}});
  auto streams = ordered_json::array();
  for (const auto& stream : f.streams) streams.push_back(toJson(stream));
  auto views = ordered_json::array();
  for (const auto& candidate : f.view.candidates)
    views.push_back({{"factor", candidate.factor}, {"cost", candidate.cost}});
  return {{"log", f.path},
          {"format", f.format},
          {"usable", check.isUsable()},
          {"warnings", check.warnings()},
          {"findings", findings},
          {"streams", streams},
          {"backward_in_file", f.backward_in_file},
          {"lidar", f.lidar},
          {"ranges", rangesJson(f.ranges)},
          {"view_given", f.is_view_given},
          {"view_factor", f.view.is_observable ? toJson(f.view.factor) : ordered_json()},
          {"view_candidates", views},
          {"sweep_stated_s", f.stated_sweep ? ordered_json(f.stated_sweep->duration_s) : ordered_json()},
          {"sweep_s", f.sweep.is_observable ? toJson(f.sweep.duration_s) : ordered_json()},
          {"matched_pairs", f.matched_pairs},
          {"unmatched_pairs", f.unmatched_pairs},
          {"odometry", odometryJson(f)},
          {"fit", fitJson(f.fit)},
          {"disagreements", f.disagreements},
          {"truth", f.has_truth}};
}

void printStreams(const std::vector<calibration::StreamFigures>& streams) {
  for (const auto& stream : streams) {
    std::printf("stream  %-26s %-18s %8lu", stream.kind.c_str(), ("'" + stream.label + "'").c_str(),
                static_cast<unsigned long>(stream.count));
    if (stream.mean_period_s > 0) std::printf(" %9.2f Hz", 1 / stream.mean_period_s);
    std::printf("\n");
  }
}

void printFindings(const std::vector<doctor::Finding>& findings) {
  for (const auto& finding : findings) {
    printWrapped(padded(doctor::severityName(finding.severity), 8) + padded(finding.key, 11),
                 finding.text + ".");
    if (!finding.advice.empty()) printWrapped(std::string(19, ' ') + "-> ", finding.advice + ".");
  }
}

int checkLog(const Context& context, const CheckArguments& arguments) {
  ConsoleProgress progress(context.quiet);
  const auto check = doctor::checkLog(arguments.log, arguments.lidar, progress);
  if (context.json) {
    std::cout << toJson(check).dump(2, ' ', false, ordered_json::error_handler_t::replace) << "\n";
  } else {
    std::printf("log     %s\n", arguments.log.c_str());
    printStreams(check.figures.streams);
    std::fflush(stdout);
    printFindings(check.findings);
    const int warnings = check.warnings();
    std::cout << (!check.isUsable() ? "not usable as it is"
                  : warnings == 0   ? "usable"
                                    : "usable, with " + std::to_string(warnings) +
                                        (warnings == 1 ? " warning" : " warnings"))
              << "\n";
  }
  return static_cast<int>(check.isUsable() ? core::ExitCode::kOk : core::ExitCode::kBadInput);
}

std::string footer() {
  std::string text = "What is looked for, in this order:\n";
  for (const auto& [key, meaning] : doctor::findingKeys()) text += "  " + padded(key, 11) + meaning + "\n";
  return text +
         "Figures in brackets are 95 % intervals.\n"
         "Exit code: 0 the log can be used (also with warnings), 3 it cannot as it is.\n"
         "Examples:\n"
         "  rasterslam check run.rawlog\n"
         "  rasterslam check intel.clf.bz2 --json";
}

}  // namespace

void addCheck(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("check", "say what is wrong with a log, and what to do about it");
  auto arguments = std::make_shared<CheckArguments>();
  command->add_option("log", arguments->log, "a log of any format that is read here")->required();
  command->add_option("--label", arguments->lidar,
                      "the lidar to look at (default: the one with the most scans)");
  addQuiet(command, context);
  addJson(command, context);
  command->footer(footer());
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return checkLog(context, *arguments); };
  });
}

}  // namespace slam::apps
