#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/quiet.h"
#include "libslam/core/error.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/reach/reach_goal.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/run/build_map.h"
#include "libslam/run/external_method.h"
#include "libslam/run/told_commands.h"

namespace slam::apps {
namespace {

struct RunArguments {
  std::string method, log, continued, localised, lidars, relations;
  std::string start;  ///< x_m,y_m,yaw_deg
  bool journal = false, keep_partial = false;
  int threads = 1;
};

run::Continuation continuationOf(const RunArguments& arguments) {
  run::Continuation continuation;
  continuation.localise_only = !arguments.localised.empty();
  continuation.folder = continuation.localise_only ? arguments.localised : arguments.continued;
  if (arguments.start.empty()) return continuation;
  if (continuation.folder.empty())
    throw core::InputError(
        "--start belongs to --continue or --localise: a map of its own begins at the robot");
  continuation.T_map_robot = reach::parsePose(arguments.start, "--start");
  return continuation;
}

/// Says once that a robot is not found in a map, while there is time to take another.
class NotFoundYet : public record::StepObserver {
 public:
  NotFoundYet(const Context& context, std::string map) : context_(context), map_(std::move(map)) {}
  void onStep(const record::Step& step) override {
    constexpr double kPatience_s = 60;
    if (has_looked_ || step.time_s < kPatience_s || step.method == nullptr) return;
    has_looked_ = true;
    bool was_found = false, was_lost = false;
    for (const auto& entry : mapping::journalOf(*step.method)) {
      was_found = was_found || entry.event == core::JournalEvent::kRecovered;
      was_lost = was_lost || (entry.event == core::JournalEvent::kLost && entry.scan <= 0);
    }
    if (was_lost && !was_found)
      note(context_, map_ + ": the robot is not found in it after " + files::formatNumber(kPatience_s) +
                         " s of the log: is it the map of another place?");
  }

 private:
  const Context& context_;
  std::string map_;
  bool has_looked_ = false;
};

run::BuildOptions buildOptions(const RunArguments& arguments, record::StepObserver& of_localising) {
  run::BuildOptions options;
  options.continuation = continuationOf(arguments);
  if (!arguments.localised.empty()) options.observer = &of_localising;
  options.keep_partial = arguments.keep_partial;
  if (!arguments.relations.empty()) options.relations = logs::readRelations(arguments.relations);
  options.threads = arguments.threads;
  return options;
}

nlohmann::ordered_json journalJson(const std::vector<core::JournalLine>& journal) {
  auto list = nlohmann::ordered_json::array();
  for (const auto& line : journal) {
    nlohmann::ordered_json entry{{"scan", line.scan},
                                 {"time_s", line.time_s},
                                 {"event", core::wordOf(line.event)},
                                 {"value", line.value},
                                 {"place_m", {line.place.x, line.place.y}}};
    if (line.other_scan >= 0) entry["other_scan"] = line.other_scan;
    if (!line.detail.empty()) entry["detail"] = line.detail;
    list.push_back(std::move(entry));
  }
  return list;
}

nlohmann::ordered_json resultJson(const std::string& name, const std::string& folder,
                                  const run::MapRun& result, bool with_journal) {
  const auto& end = result.end;
  const auto lost = results::lostInTheEnd(result.journal);
  nlohmann::ordered_json json{{"folder", folder},
                              {"method", name},
                              {"scans", result.estimate.size()},
                              {"path_length_m", result.path_length_m},
                              {"end_pose", {end.x, end.y, end.phi}},
                              {"mean_ms_per_scan", result.cost.mean_ms_per_scan},
                              {"p99_ms_per_scan", result.cost.p99_ms_per_scan},
                              {"peak_memory_mb", result.cost.peak_memory_mb}};
  if (!result.commands_from.empty()) json["commands_from"] = result.commands_from;
  if (result.lost_share) json["lost_share"] = *result.lost_share;
  if (lost) json["lost"] = results::lostText(*lost);
  if (result.stopped)
    json[core::wordOf(results::eventOf(*result.stopped))] = results::stopText(*result.stopped);
  if (with_journal) json["journal"] = journalJson(result.journal);
  return json;
}

core::ExitCode exitCodeOf(const run::MapRun& result, bool is_lost) {
  if (!result.stopped) return is_lost ? core::ExitCode::kMethodFailed : core::ExitCode::kOk;
  return result.stopped->reason == results::Stop::Reason::kFailed ? core::ExitCode::kMethodFailed
                                                                  : core::ExitCode::kInterrupted;
}

std::string stoppedText(const results::Stop& stop) {
  return core::wordOf(results::eventOf(stop)) + (" " + results::stopText(stop)) +
         "; what was mapped before is kept";
}

int runMethod(const Context& context, const RunArguments& arguments) {
  auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", arguments.method);
  if (!context.config.empty()) config.overrideWith(resources::readConfigFile(context.config));
  for (const auto& setting : context.settings) config.setFromArgument(setting, "--set");
  if (!arguments.lidars.empty()) config.set("method", "lidars", arguments.lidars, "--lidars");
  const std::string name = std::filesystem::path(arguments.method).stem().string();
  if (context.print_config) {
    printParameters(run::methodParameters(config), context.json);
    return 0;
  }
  const std::string folder = context.output.empty() ? name : context.output;
  ConsoleProgress progress(context.quiet);
  NotFoundYet not_found(context, arguments.localised);
  const auto result = run::buildMap(arguments.log, config, name, context.seed, folder, context.overwrite,
                                    context.manifest(), progress, buildOptions(arguments, not_found));
  const auto lost = results::lostInTheEnd(result.journal);
  const auto exit_code = static_cast<int>(exitCodeOf(result, lost.has_value()));
  if (result.stopped)
    std::fprintf(stderr, "rasterslam: %s %s\n", name.c_str(), stoppedText(*result.stopped).c_str());
  if (lost)
    std::fprintf(stderr, "rasterslam: %s: %s and not found again\n", name.c_str(),
                 results::lostText(*lost).c_str());
  if (result.steps_without_odometry > 0)
    note(context, arguments.log + ": " + std::to_string(result.steps_without_odometry) + " of " +
                      std::to_string(result.estimate.size() - 1) +
                      " steps come without odometry, estimated from the scans instead");
  if (const auto commands = run::commandsNote(name, result.commands_from); !commands.empty())
    note(context, commands);
  for (const auto& remark : result.remarks) note(context, arguments.log + ": " + remark);
  if (!result.skew_note.empty()) note(context, result.skew_note);
  const auto& end = result.end;
  if (context.json) {
    std::cout << resultJson(name, folder, result, arguments.journal).dump(2) << "\n";
    return exit_code;
  }
  if (arguments.journal)
    std::cout << (!result.journal.empty() ? results::journalText(result.journal)
                  : result.final_estimate ? "method " + name + " has nothing to tell\n"
                                          : "method " + name + " wrote no journal\n")
              << "\n"
              << std::flush;
  std::printf("%s: %zu scans, path %.2f m, end at x %.2f m, y %.2f m, yaw %.1f deg\n", name.c_str(),
              result.estimate.size(), result.path_length_m, end.x, end.y, core::radToDeg(end.phi));
  std::string p99;
  if (std::isfinite(result.cost.p99_ms_per_scan))
    p99 = " (p99 " + files::formatNumber(std::round(1000 * result.cost.p99_ms_per_scan) / 1000) + ")";
  std::printf("%.3f ms per scan%s, %.0f x real time, %.1f MB\n", result.cost.mean_ms_per_scan, p99.c_str(),
              result.cost.real_time_factor, result.cost.peak_memory_mb);
  if (result.lost_share && (*result.lost_share > 0 || !arguments.localised.empty()))
    std::printf("lost %.1f %% of the time\n", 100 * *result.lost_share);
  if (result.filled_poses > 0)
    std::printf("%d scans have no pose of its own, but one from the odometry between their neighbours'\n",
                result.filled_poses);
  const auto manifest = resources::readManifest(folder + "/manifest.json");
  for (const auto& [file, meaning] : manifest.files)
    std::printf("  %-32s %s\n", (folder + "/" + file).c_str(), meaning.c_str());
  return exit_code;
}

}  // namespace

void addRun(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("run", "run one SLAM method over a log; writes its map and path");
  auto arguments = std::make_shared<RunArguments>();
  command->add_option("method", arguments->method, "a name of 'rasterslam list methods', or an .ini file")
      ->required();
  command->add_option("log", arguments->log, "a log: MRPT rawlog, CARMEN, ...")->required();
  command->add_flag("--journal", arguments->journal, "print what the method says of its work, scan by scan");
  command->add_flag("--keep-partial", arguments->keep_partial,
                    "an interrupt (Ctrl-C) keeps what was mapped until then");
  auto* continued = command->add_option("--continue", arguments->continued,
                                        "folder of an earlier run: go on in its map (graph, particles, icp)");
  command
      ->add_option("--localise", arguments->localised,
                   "find the way in a map, which stays as it is: folder of an earlier run, map.simplemap, "
                   "ROS map yaml or "
                   ".gridmap.gz")
      ->excludes(continued);
  command->add_option(
      "--start", arguments->start,
      "where the log begins in that map: x_m,y_m,yaw_deg (default: where that run ended; with --localise and "
      "a method of type graph it is found anywhere)");
  command
      ->add_option(
          "--threads", arguments->threads,
          "2 or more: the log is read ahead, graph closes loops beside the scans to come, particles are "
          "shared out, and the map is written while the scans are held against it; the same bytes")
      ->check(CLI::Range(1, 256));
  command->add_option("--lidars", arguments->lidars,
                      "sensor labels of the lidars to use, as front,rear (default: all 2D scanners)");
  command->add_option(
      "--relations", arguments->relations,
      "relations of the log: covariances_relative.csv says how sure the method is of them, for "
      "'eval --relations'");
  addOutput(command, context, "folder to write (default: the method's name)");
  addSeed(command, context);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam run icp run.rawlog -o out\n"
      "  rasterslam run rbpf_exact run.rawlog -o out --set mapping.resolution_m=0.05 --seed 3\n"
      "  rasterslam run icp run.rawlog --print-config\n"
      "  rasterslam run graph monday.rawlog -o monday --journal\n"
      "  rasterslam run graph tuesday.rawlog -o both --continue monday --start 0,0,0\n"
      "  rasterslam run graph wednesday.rawlog -o path --localise both --start 2.5,-1,90\n"
      "  rasterslam run graph thursday.rawlog -o path --localise plan.yaml --start 2.5,-1,90\n"
      "Exit code 4: the robot was lost and not found again, all files are written; or the method failed on\n"
      "the way: what it mapped until then is written. 130: interrupted.");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return runMethod(context, *arguments); };
  });
}

}  // namespace slam::apps
