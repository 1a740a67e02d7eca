#include <signal.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/gate_flags.h"
#include "apps/help_text.h"
#include "apps/quiet.h"
#include "libslam/core/error.h"
#include "libslam/process/worker.h"
#include "libslam/study/sweep_gate.h"
#include "libslam/summary/sweep_brief.h"
#include "libslam/summary/sweep_merge.h"
#include "libslam/sweep/cell.h"
#include "libslam/sweep/submit.h"
#include "libslam/sweep/sweep.h"

namespace slam::apps {
namespace {

struct BenchArguments {
  std::string suite, shard, cell;
  std::vector<std::string> folders;  ///< of merge
  sweep::SubmitRequest submission;
  GateFlags gate;
  int jobs = 1;
  bool resume = false, retry = false, check = false, go = false;
};

int plan(const Context& context, const BenchArguments& arguments) {
  const auto sweep = sweep::planSweep(arguments.suite);
  const auto table = sweep::planTable(sweep.plan);
  if (context.json)
    std::cout << sweep::toJson(sweep.plan, ".");
  else
    std::cout << tableText(table);
  return 0;
}

/// "2/8"
void setShard(const std::string& text, sweep::SweepRequest& request) {
  if (text.empty()) return;
  int end = 0;
  const int count = std::sscanf(text.c_str(), "%zu/%zu%n", &request.shard, &request.of, &end);
  if (count != 2 || static_cast<std::size_t>(end) != text.size() || request.shard < 1 ||
      request.shard > request.of)
    throw core::InputError("--shard: found '" + text + "', expected i/n with i from 1 to n, such as 2/8");
}

sweep::SweepRequest requestOf(const Context& context, const BenchArguments& arguments) {
  sweep::SweepRequest request;
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

int exitCode(const sweep::SweepOutcome& outcome) {
  const bool whole = outcome.failed == 0 && outcome.lost.empty();
  return static_cast<int>(whole ? core::ExitCode::kOk : core::ExitCode::kCellsFailed);
}

void describe(const Context& context, const sweep::SweepOutcome& outcome) {
  for (const auto& line : outcome.repaired) note(context, "done again: " + line);
  for (const auto& line : outcome.lost) std::fprintf(stderr, "rasterslam: %s\n", line.c_str());
}

int execute(const Context& context, const BenchArguments& arguments) {
  auto request = requestOf(context, arguments);
  request.resume = true;
  ConsoleProgress progress(context.quiet), cell_progress(true);
  request.cell_progress = &cell_progress;
  const auto outcome = sweep::sweep(sweep::planSweep(arguments.suite), request, context.manifest(), progress);
  describe(context, outcome);
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

constexpr std::size_t kMostLines = 20;

/// Before hours of work, what is wrong with the baseline's file.
void requireUsableGate(const Context& context, const GateFlags& flags, const sweep::SweepPlan& plan) {
  slam::apps::requireUsableGate(context, flags,
                                study::scoresOf(plan, summary::SweepResults(plan.runs.size())));
}

/// 6 where runs are missing; where they failed too, unless a baseline says what may fail.
int exitCode(const summary::MergedSweep& merged, const GateResult& gate) {
  if (gate.exit_code != 0) return gate.exit_code;
  const bool whole = merged.missing.empty() && (merged.failed == 0 || gate.table);
  return static_cast<int>(whole ? core::ExitCode::kOk : core::ExitCode::kCellsFailed);
}

int reportMerged(const Context& context, const GateFlags& flags, const summary::MergedSweep& merged,
                 const std::string& folder) {
  for (std::size_t i = 0; i < std::min(merged.missing.size(), kMostLines); ++i)
    std::fprintf(stderr, "rasterslam: %s\n", merged.missing[i].c_str());
  if (merged.missing.size() > kMostLines)
    std::fprintf(stderr, "rasterslam: and %zu more cells\n", merged.missing.size() - kMostLines);
  if (!flags.write_gate.empty() && !merged.missing.empty())
    throw core::InputError(folder + ": " + std::to_string(merged.missing.size()) +
                           " cells are missing, expected a whole sweep to make a baseline of");
  const auto gate = checkGate(context, flags, study::scoresOf(merged.plan, merged.results));
  writeGate(context, flags, study::summaryScoresOf(merged.plan, merged.results));
  const auto parsed = [](const table::Table& table) {
    return nlohmann::ordered_json::parse(table::toJson(table));
  };
  if (context.json) {
    nlohmann::ordered_json json = {{"folder", folder},
                                   {"runs", merged.plan.runs.size()},
                                   {"complete", merged.complete},
                                   {"failed", merged.failed},
                                   {"missing", merged.missing},
                                   {"summary", parsed(merged.full_summary)},
                                   {"consistency", parsed(merged.consistency)},
                                   {"cost", parsed(merged.costs)}};
    if (gate.table) json["gate"] = parsed(*gate.table);
    std::cout << json.dump(2) << "\n";
  } else {
    const auto brief = summary::briefOf(merged.plan, {merged.summary, merged.full_summary});
    std::cout << tableText(brief.overall) << "\n";
    if (!brief.worst.rows.empty()) std::cout << tableText(brief.worst) << "\n";
    std::cout << tableText(merged.costs) << "\n";
    if (gate.table) std::cout << gateText(*gate.table) << "\n";
    std::cout << "every setting: " << folder << "/summary.txt; every run: " << folder
              << "/results.csv; failures, consistency, costs beside them\n";
  }
  return exitCode(merged, gate);
}

int merge(const Context& context, const BenchArguments& arguments) {
  summary::MergeRequest request;
  for (const auto& folder : arguments.folders)
    request.folders.push_back(std::filesystem::path(folder).lexically_normal().string());
  request.output = context.output.empty() ? request.folders.front() : context.output;
  request.check_bytes = arguments.check;
  ConsoleProgress progress(true);
  const auto merged = summary::mergeSweep(request, context.manifest(), progress);
  return reportMerged(context, arguments.gate, merged, request.output);
}

int submit(const Context& context, const BenchArguments& arguments) {
  const auto sweep = sweep::planSweep(arguments.suite);
  const auto script =
      sweep::writeSubmission(sweep, requestOf(context, arguments), arguments.submission, context.manifest());
  if (!arguments.go) {
    std::printf("next: sh %s\n", resources::shellQuoted({script}).c_str());
    return 0;
  }
  ConsoleProgress progress(true);
  const auto result = process::runWorker({"/bin/sh", script}, progress);
  std::cout << result.out;
  return result.exit_code;
}

/// Everything: cells, then tables, also of what an interrupt has left.
int bench(const Context& context, const BenchArguments& arguments) {
  if (arguments.suite.empty())
    throw core::InputError("bench: no suite named, expected the sweep's .ini or .yaml");
  const auto sweep = sweep::planSweep(arguments.suite);
  auto request = requestOf(context, arguments);
  if (request.output.empty()) request.output = sweep.plan.name;
  requireUsableGate(context, arguments.gate, sweep.plan);
  ConsoleProgress progress(context.quiet), cell_progress(true);
  request.cell_progress = &cell_progress;
  summary::MergeRequest whole;
  whole.folders = {request.output};
  whole.output = request.output;
  try {
    describe(context, sweep::sweep(sweep, request, context.manifest(), progress));
  } catch (const core::Interrupted&) {
    summary::mergeSweep(whole, context.manifest(), core::silentProgress());
    note(context, "the tables in " + request.output + " hold what is done");
    throw;
  }
  const auto merged = summary::mergeSweep(whole, context.manifest(), core::silentProgress());
  return reportMerged(context, arguments.gate, merged, request.output);
}

struct CellArguments {
  std::string folder;
  sweep::CellInputs inputs;
  int parent = 0;
};

/// The process that does one cell. It ends with the process that started it.
int workOnCell(const CellArguments& arguments) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (arguments.parent != 0 && getppid() != arguments.parent) throw core::Interrupted();
  ConsoleProgress progress(true);
  sweep::workOnCell(arguments.folder, arguments.inputs, progress);
  return 0;
}

void addSuite(CLI::App* command, BenchArguments& arguments) {
  command->add_option("suite", arguments.suite, "the sweep's .ini or .yaml: see configs/suites")->required();
}

void addJobs(CLI::App* command, BenchArguments& arguments) {
  command->add_option("-j,--jobs", arguments.jobs, "cells side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--retry", arguments.retry, "do cells again that failed");
}

void addPlan(CLI::App& bench, Context& context, const std::shared_ptr<BenchArguments>& arguments) {
  auto* command = bench.add_subcommand("plan", "list the cells of a sweep, and do nothing");
  addSuite(command, *arguments);
  addJson(command, context);
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return plan(context, *arguments); };
  });
}

void addExec(CLI::App& bench, Context& context, const std::shared_ptr<BenchArguments>& arguments) {
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

void addMerge(CLI::App& bench, Context& context, const std::shared_ptr<BenchArguments>& arguments) {
  auto* command = bench.add_subcommand("merge", "check a sweep, bring its parts together, write its tables");
  command->add_option("folders", arguments->folders, "of one sweep, or of its parts")->required();
  command->add_option("-o,--output", context.output, "folder of the whole (default: the first)");
  command->add_flag("--check", arguments->check, "read every file of every cell again");
  addGateFlags(command, arguments->gate);
  command->add_flag("--overwrite", context.overwrite,
                    "with --write-gate: replace the values of these methods; their tolerances stay");
  addJson(command, context);
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return merge(context, *arguments); };
  });
}

void addSubmit(CLI::App& bench, Context& context, const std::shared_ptr<BenchArguments>& arguments) {
  auto* command =
      bench.add_subcommand("submit", "write the scripts that hand a sweep to GNU parallel or Slurm");
  addSuite(command, *arguments);
  auto& submission = arguments->submission;
  command->add_option("--engine", submission.engine, "parallel or slurm")
      ->required()
      ->check(oneOf(sweep::submitEngines()));
  command->add_option("--tasks", submission.tasks, "parts of the sweep, each with many cells")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command
      ->add_option("--option", submission.options,
                   "of sbatch, such as --option=--partition=long; repeat for more")
      ->take_all()
      ->expected(1);
  command->add_flag("--go", arguments->go, "run the script, too");
  command->add_flag("--resume", arguments->resume, "go on in a folder that is there");
  addJobs(command, *arguments);
  addOutput(command, context, "the sweep's folder, on a disk that all machines share");
  command->get_option("--output")->required();
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return submit(context, *arguments); };
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
  auto arguments = std::make_shared<BenchArguments>();
  command->add_option("suite", arguments->suite, "the sweep's .ini or .yaml: see configs/suites");
  addJobs(command, *arguments);
  command->add_flag("--resume", arguments->resume, "keep the cells that are complete");
  addGateFlags(command, arguments->gate);
  addOutput(command, context, "folder to write (default: the suite's name)");
  addJson(command, context);
  addPlan(*command, context, arguments);
  addExec(*command, context, arguments);
  addMerge(*command, context, arguments);
  addSubmit(*command, context, arguments);
  addCell(*command, context);
  command->footer(
      "Exit codes: 0 every run ok; 5 worse than --gate allows; 6 runs failed (not with --gate, which judges\n"
      "that) or are missing; 130 interrupted, with tables of what is done.\n"
      "Examples:\n"
      "  rasterslam bench configs/suites/smoke.ini -o out -j 2\n"
      "  rasterslam bench configs/suites/smoke.ini -o out --resume\n"
      "  rasterslam bench plan configs/suites/standard.ini\n"
      "  rasterslam bench exec SUITE.ini -o part1 --shard 1/2      # and 2/2 on another machine\n"
      "  rasterslam bench merge part1 part2 -o out\n"
      "  rasterslam bench merge out --write-gate baseline.json     # then edit its tolerances\n"
      "  rasterslam bench SUITE.ini -o out2 --gate baseline.json   # the same seeds, pair by pair\n"
      "  rasterslam bench submit SUITE.ini -o out --engine slurm --tasks 50 --go");
  command->callback([&context, arguments, command] {
    if (command->get_subcommands().empty())
      context.action = [&context, arguments] { return bench(context, *arguments); };
  });
}

}  // namespace slam::apps
