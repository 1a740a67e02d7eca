#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/run/cell.h"
#include "libslam/run/sweep.h"

namespace slam::apps {
namespace {

struct Arguments {
  std::string suite, shard, cell;
  int jobs = 1;
  bool resume = false, retry = false;
};

/// A suite; or the copy of one in a sweep's folder, whose paths still start from where it came from.
run::Sweep planOf(const std::string& suite_path) {
  const std::string plan = (std::filesystem::absolute(suite_path).parent_path() / "plan.json").string();
  std::string folder;
  if (std::filesystem::path(suite_path).filename() == "suite.ini" && std::filesystem::exists(plan))
    folder = run::readSweepPlan(plan).suite_folder;
  return run::planSweep(run::readSuite(suite_path, folder));
}

int plan(const Context& context, const Arguments& arguments) {
  const auto sweep = planOf(arguments.suite);
  const auto table = run::planTable(sweep.plan);
  if (context.json)
    std::cout << run::toJson(sweep.plan);
  else
    std::cout << report::toText(table);
  return 0;
}

/// "2/8"
void setShard(const std::string& text, run::SweepRequest& request) {
  if (text.empty()) return;
  int end = 0;
  const int count = std::sscanf(text.c_str(), "%zu/%zu%n", &request.shard, &request.of, &end);
  if (count != 2 || static_cast<std::size_t>(end) != text.size() || request.shard < 1 ||
      request.shard > request.of)
    throw core::InputError("--shard: found '" + text + "', expected i/n with i from 1 to n, such as 2/8");
}

run::SweepRequest requestOf(const Context& context, const Arguments& arguments) {
  run::SweepRequest request;
  request.output = context.output;
  request.program = context.programPath();
  request.jobs = arguments.jobs;
  request.resume = arguments.resume;
  request.overwrite = context.overwrite;
  request.retry = arguments.retry;
  request.only_cell = arguments.cell;
  setShard(arguments.shard, request);
  return request;
}

void say(const std::vector<std::string>& lines, const char* prefix) {
  for (const auto& line : lines) std::fprintf(stderr, "rasterslam: %s%s\n", prefix, line.c_str());
}

int exitCode(const run::SweepOutcome& outcome) {
  const bool whole = outcome.failed == 0 && outcome.lost.empty();
  return static_cast<int>(whole ? core::ExitCode::kOk : core::ExitCode::kCellsFailed);
}

void describe(const run::SweepOutcome& outcome) {
  say(outcome.repaired, "done again: ");
  say(outcome.lost, "");
}

int execute(const Context& context, const Arguments& arguments) {
  auto request = requestOf(context, arguments);
  request.resume = true;
  ConsoleProgress progress(context.quiet);
  const auto outcome = run::sweep(planOf(arguments.suite), request, context.manifest(), progress);
  describe(outcome);
  if (context.json)
    std::cout << nlohmann::ordered_json{{"folder", request.output},
                                        {"done", outcome.done},
                                        {"reused", outcome.reused},
                                        {"failed", outcome.failed},
                                        {"lost", outcome.lost}}
                     .dump(2)
              << "\n";
  else
    std::printf("%zu cells done, %zu kept, %zu failed, %zu lost: %s\n", outcome.done, outcome.reused,
                outcome.failed, outcome.lost.size(), request.output.c_str());
  return exitCode(outcome);
}

struct CellArguments {
  std::string folder;
  run::CellInputs inputs;
  int parent = 0;
};

/// The process that does one cell. It ends with the process that started it.
int workOnCell(const CellArguments& arguments) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (arguments.parent != 0 && getppid() != arguments.parent) throw core::Interrupted();
  ConsoleProgress progress(true);
  run::workOnCell(arguments.folder, arguments.inputs, progress);
  return 0;
}

void addSuite(CLI::App* command, Arguments& arguments) {
  command->add_option("suite", arguments.suite, "the sweep's .ini: see configs/suites")->required();
}

void addJobs(CLI::App* command, Arguments& arguments) {
  command->add_option("-j,--jobs", arguments.jobs, "cells side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--retry", arguments.retry, "do cells again that failed");
}

void addPlan(CLI::App& bench, Context& context, const std::shared_ptr<Arguments>& arguments) {
  auto* command = bench.add_subcommand("plan", "list the cells of a sweep, and do nothing");
  addSuite(command, *arguments);
  addJson(command, context);
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return plan(context, *arguments); };
  });
}

void addExec(CLI::App& bench, Context& context, const std::shared_ptr<Arguments>& arguments) {
  auto* command = bench.add_subcommand("exec", "do a part of a sweep, without tables; goes on where it was");
  addSuite(command, *arguments);
  command->add_option("--shard", arguments->shard, "i/n: the i-th of n parts");
  command->add_option("--cell", arguments->cell, "this cell alone (and the log that it needs)");
  addJobs(command, *arguments);
  addOutput(command, context, "the sweep's folder");
  command->get_option("--output")->required();
  addJson(command, context);
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return execute(context, *arguments); };
  });
}

/// What Worker runs; not for people.
void addCell(CLI::App& bench, Context& context) {
  auto* command = bench.add_subcommand("cell", "do the cell that lies in a folder");
  command->group("");
  auto arguments = std::make_shared<CellArguments>();
  auto& inputs = arguments->inputs;
  command->add_option("folder", arguments->folder)->required();
  command->add_option("--plan", inputs.plan);
  command->add_option("--log", inputs.log);
  command->add_option("--truth", inputs.truth);
  command->add_option("--truth-plan", inputs.truth_plan);
  command->add_option("--relations", inputs.relations);
  command->add_option("--keep", inputs.keep);
  command->add_option("--reproduce", inputs.reproduce);
  command->add_option("--time-limit", inputs.limits.time_limit_s);
  command->add_option("--memory-limit", inputs.limits.memory_limit_mb);
  command->add_option("--parent", arguments->parent);
  addJson(command, context);
  command->callback(
      [&context, arguments] { context.action = [arguments] { return workOnCell(*arguments); }; });
}

}  // namespace

void addBench(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("bench", "sweep methods over worlds, lidars, faults and seeds");
  command->require_subcommand(0, 1);
  auto arguments = std::make_shared<Arguments>();
  addPlan(*command, context, arguments);
  addExec(*command, context, arguments);
  addCell(*command, context);
}

}  // namespace slam::apps
