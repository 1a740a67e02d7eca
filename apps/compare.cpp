#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/plan_warnings.h"
#include "libslam/core/error.h"
#include "libslam/mapping/method_config.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"

namespace slam::apps {
namespace {

struct CompareArguments {
  std::string input, truth, plan, relations;
  std::vector<std::string> methods = defaultMethods();
  SimulationFlags flags;
  int threads = 1;
  bool resume = false;
};

/// Whether "section.key=value" is for methods, not for the simulation: their sections differ.
bool isOfMethods(const std::string& setting) {
  const auto section = setting.substr(0, setting.find('.'));
  for (const auto& type : mapping::methodTypes())
    for (const auto& known : mapping::methodSections(type.name))
      if (known == section) return true;
  return false;
}

int compareMethods(const Context& context, const CompareArguments& arguments) {
  score::CompareRequest request;
  const bool is_plan = resources::looksLikePlan(arguments.input);
  Context simulation = context;
  simulation.settings.clear();
  for (const auto& setting : context.settings)
    (isOfMethods(setting) ? request.method_settings : simulation.settings).push_back(setting);
  if (is_plan || context.print_config)
    request.record = record::readRecordConfig(simulationConfig(simulation, arguments.flags));
  if (context.print_config) {
    printParameters(request.record.parameters, context.json);
    return 0;
  }
  if (!is_plan && !context.config.empty())
    throw core::InputError("--config belongs to the simulation of a plan; " + arguments.input +
                           " is a log. Give methods their own .ini in --methods");
  if (!is_plan && !simulation.settings.empty())
    throw core::InputError("--set: found '" + simulation.settings.front() +
                           "', expected a section of a method, as " + arguments.input + " is a log");
  (is_plan ? request.plan_path : request.log_path) =
      is_plan ? resources::resolvePlan(arguments.input) : arguments.input;
  if (is_plan) warnOfPlan(context, request.plan_path);
  if (is_plan && !arguments.relations.empty())
    throw core::InputError("--relations belongs to a log; " + arguments.input +
                           " is a plan, whose simulation knows the whole truth");
  request.truth_path = arguments.truth;
  request.relations_path = arguments.relations;
  if (!arguments.plan.empty()) request.truth_plan_path = resources::resolvePlan(arguments.plan);
  request.methods = arguments.methods;
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = context.output.empty() ? "comparison" : context.output;
  request.seed = context.seed;
  request.threads = arguments.threads;
  request.program = context.programPath();
  request.quiet = context.quiet;
  request.overwrite = context.overwrite;
  request.resume = arguments.resume;
  ConsoleProgress progress(context.quiet);
  const auto comparison = score::compare(request, context.manifest(), progress);
  if (context.json) {
    const auto parsed = [](const table::Table& table) {
      return nlohmann::ordered_json::parse(table::toJson(table));
    };
    nlohmann::ordered_json json{{"scores", parsed(comparison.full_accuracy)}};
    if (comparison.relations) {
      json["relations"] = parsed(*comparison.relations);
      json["worst_relations"] = parsed(*comparison.worst_relations);
    }
    json["cost"] = parsed(comparison.cost);
    std::cout << json.dump(2) << "\n";
  } else {
    if (comparison.relations) std::cout << tableText(*comparison.relations) << "\n";
    std::cout << tableText(comparison.accuracy) << "\n"
              << tableText(comparison.cost) << "\nmaps, paths, pictures: " << request.output << "\n";
    if (comparison.relations) std::cout << "worst relations: " << request.output << "/relations.txt\n";
  }
  return static_cast<int>(comparison.failed ? core::ExitCode::kMethodFailed : core::ExitCode::kOk);
}

}  // namespace

void addCompare(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("compare", "run several methods on one log or plan; prints a table");
  auto arguments = std::make_shared<CompareArguments>();
  command
      ->add_option("input", arguments->input,
                   "a log (MRPT rawlog, CARMEN, ...), or a plan to simulate a log in")
      ->required();
  command->add_option("--methods", arguments->methods, "names or .ini files, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  command->add_option("--truth", arguments->truth, "true path (default: the one beside the log, if any)");
  command->add_option("--plan", arguments->plan,
                      "true plan for the map scores (default: the one the log was made in)");
  command->add_option(
      "--relations", arguments->relations,
      "score every path by relations (Freiburg benchmark: t1 t2 x y z roll pitch yaw per line): the pose "
      "with the same stamp to 1 us, else interpolated between its neighbours; outside the path's time "
      "not scored");
  command->add_option("--threads", arguments->threads, "methods side by side")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  command->add_flag("--resume", arguments->resume,
                    "keep the methods that an interrupted comparison has finished");
  addOutput(command, context, "folder to write (default comparison)");
  addSeed(command, context);
  addSimulationFlags(command, arguments->flags);
  addConfig(command, context);
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam compare run.rawlog -o out\n"
      "  rasterslam compare office_loop -o out --methods icp,rbpf_exact,my_icp.ini --seed 5\n"
      "  rasterslam compare run.rawlog --methods graph,icp --set graph.keyframe_m=0.5     # of those that "
      "have it\n"
      "  rasterslam compare intel.clf --relations intel.relations --methods naive_wheel,icp,rbpf_exact\n"
      "  rasterslam compare \"/usr/share/mrpt/datasets/2006-01ENE-21-SENA_Telecom "
      "Faculty_one_loop_only.rawlog\"");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return compareMethods(context, *arguments); };
  });
}

}  // namespace slam::apps
