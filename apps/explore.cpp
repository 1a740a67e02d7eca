#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/plan_warnings.h"
#include "apps/user_input.h"
#include "libslam/core/error.h"
#include "libslam/explore/explore.h"
#include "libslam/files/files.h"
#include "libslam/files/word_list.h"
#include "libslam/reach/reach_goal.h"
#include "libslam/resources/resources.h"
#include "libslam/teams/team.h"

namespace slam::apps {
namespace {

struct ExploreArguments {
  std::string plan, slam = kExplorersSlam;
  SimulationFlags flags;
  std::vector<std::string> carries;
  int seeds = 1, threads = 1;
  bool return_to_start = false, tables_only = false, oracle = false;
  int robots = 1;
  std::optional<double> radio_range_m;
  std::vector<std::string> starts;
};

/// One configuration per strategy; they are the same but for its name.
std::vector<explore::ExploreConfig> configsOf(const Context& context, const ExploreArguments& arguments) {
  SimulationFlags flags = arguments.flags;
  auto names = files::namesIn(flags.strategy, ',');
  if (names.empty()) names.emplace_back();  // the configuration's own
  std::vector<explore::ExploreConfig> configs;
  for (const auto& name : names) {
    flags.strategy = name;
    auto ini = withCarries(simulationConfig(context, flags), arguments.carries);
    if (arguments.return_to_start) ini.set("exploration", "return_to_start", "true", "--return");
    configs.push_back(explore::readExploreConfig(ini));
  }
  return configs;
}

/// What belongs to one robot alone or to several alone.
void checkRobots(const ExploreArguments& arguments, std::size_t strategies) {
  const auto refuse = [](const std::string& what, const std::string& found, const std::string& expected) {
    throw core::InputError(what + ": found " + found + ", expected " + expected);
  };
  const std::string robots = "--robots " + std::to_string(arguments.robots);
  if (arguments.robots == 1) {
    if (arguments.radio_range_m) refuse("--radio-range", "one robot", "--robots 2 to 4 with it");
    if (!arguments.starts.empty()) refuse("--starts", "one robot", "--start, or --robots 2 to 4 with it");
    return;
  }
  if (arguments.seeds != 1)
    refuse(robots, "--seeds " + std::to_string(arguments.seeds), "one seed at a time");
  if (strategies > 1) refuse(robots, std::to_string(strategies) + " strategies", "one at a time");
  if (arguments.oracle) refuse(robots, "--oracle", "no tour of one robot beside several");
  if (!arguments.starts.empty() && !arguments.flags.start.empty())
    refuse("--starts", "--start beside it", "one of the two");
}

/// What an exploration by one robot and one by several have in common.
template <typename Request>
Request requestOf(const Context& context, const ExploreArguments& arguments) {
  Request request;
  request.plan_path = resources::resolvePlan(arguments.plan);
  warnOfPlan(context, request.plan_path);
  request.slam = arguments.slam;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = context.output.empty() ? "exploration" : context.output;
  request.seed = context.seed;
  request.threads = arguments.threads;
  request.tables_only = arguments.tables_only;
  request.overwrite = context.overwrite;
  return request;
}

int exploreTogether(const Context& context, const ExploreArguments& arguments,
                    const explore::ExploreConfig& config) {
  auto request = requestOf<teams::TeamRequest>(context, arguments);
  request.config = config;
  request.robots = arguments.robots;
  if (arguments.radio_range_m) request.radio_range_m = *arguments.radio_range_m;
  for (const auto& start : arguments.starts)
    request.T_world_starts.push_back(reach::parsePose(start, "--starts"));
  ConsoleProgress progress(context.quiet);
  const auto result = teams::exploreTeam(request, context.manifest(), progress);
  if (context.json)
    std::cout << files::readTextFile(request.output + "/exploration.json");
  else
    std::cout << tableText(result.scores) << "\npictures, maps, tables: " << request.output << "\n";
  return static_cast<int>(result.failed ? core::ExitCode::kMethodFailed : core::ExitCode::kOk);
}

int explorePlan(const Context& context, const ExploreArguments& arguments) {
  auto strategies = configsOf(context, arguments);
  if (context.print_config) {
    printParameters(strategies.front().record.parameters, context.json);
    return 0;
  }
  checkRobots(arguments, strategies.size());
  if (arguments.robots != 1) return exploreTogether(context, arguments, strategies.front());
  auto request = requestOf<explore::ExploreRequest>(context, arguments);
  request.strategies = std::move(strategies);
  request.seeds = arguments.seeds;
  request.oracle = arguments.oracle;
  ConsoleProgress progress(context.quiet);
  const auto result = explore::explore(request, context.manifest(), progress);
  if (context.json)
    std::cout << nlohmann::ordered_json{{"folder", request.output},
                                        {"scores",
                                         nlohmann::ordered_json::parse(table::toJson(result.scores))},
                                        {"cost", nlohmann::ordered_json::parse(table::toJson(result.cost))}}
                     .dump(2)
              << "\n";
  else
    std::cout << tableText(result.scores) << "\npictures, maps, tables: " << request.output << "\n";
  return static_cast<int>(result.failed ? core::ExitCode::kMethodFailed : core::ExitCode::kOk);
}

void addRobots(CLI::App* command, ExploreArguments& arguments) {
  command->add_option("--robots", arguments.robots, "how many explore together, 1 to 4")
      ->capture_default_str();
  command->add_option("--radio-range", arguments.radio_range_m,
                      "robots no farther apart share maps and goals: metres, 0 = never (default: always)");
  command
      ->add_option("--starts", arguments.starts,
                   "of each robot: x,y,deg in the world frame (default: beside the first)")
      ->expected(1, -1);
}

}  // namespace

void addExplore(CLI::App& app, Context& context) {
  auto* command =
      app.add_subcommand("explore", "let a robot explore a plan by its own map; scored on the true plan");
  auto arguments = std::make_shared<ExploreArguments>();
  command->add_option("plan", arguments->plan, "bmp, png, pgm, jpg, a ROS map yaml, or a world by name")
      ->required();
  command
      ->add_option("--slam", arguments->slam,
                   "the method that estimates pose and map: a name of 'rasterslam list methods', an .ini "
                   "file, or truth (reference without SLAM)")
      ->capture_default_str();
  addOutput(command, context, "folder to write (default exploration)");
  addSeed(command, context);
  command->add_option("--seeds", arguments->seeds, "number of runs per strategy, with seeds from --seed on")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--threads", arguments->threads, "runs side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("--return", arguments->return_to_start, "after finishing drive back to the start");
  command->add_flag("--oracle", arguments->oracle,
                    "score against tours of somebody who knows the plan: columns ratio, oracle.*");
  command->add_flag("--tables-only", arguments->tables_only, "no log, map and pictures for every run");
  addRobots(command, *arguments);
  addSimulationFlags(command, arguments->flags);
  addCarry(command, arguments->carries);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "--strategy takes several names, separated by commas: one row each.\n"
      "Exit codes: 0 ok, also when the robot got stuck; 3 bad input; 4 when the SLAM method failed\n"
      "(what it had mapped is kept).\n"
      "Examples:\n"
      "  rasterslam explore flat --strategy nearest_frontier --slam rbpf_exact -o out\n"
      "  rasterslam explore office_loop --strategy longest_ray,quadrant --seeds 10 --tables-only -o out\n"
      "  rasterslam explore flat --strategy nearest_frontier,next_best_view --slam truth --oracle -o out\n"
      "  rasterslam explore flat --strategy nearest_frontier --sensor camera --set camera.pitch_deg=30 -o "
      "out\n"
      "  rasterslam explore office_loop --robots 3 --strategy next_best_view --slam graph -o team\n"
      "  rasterslam explore flat --carry 60:11,2,90 -o out   # kidnapped after a minute");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return explorePlan(context, *arguments); };
  });
}

}  // namespace slam::apps
