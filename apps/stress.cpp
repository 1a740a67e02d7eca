#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/resources/resources.h"
#include "libslam/study/stress.h"
#include "libslam/summary/sweep_merge.h"
#include "libslam/sweep/sweep.h"
#include "libslam/table/latex.h"

namespace slam::apps {
namespace {

struct StressArguments {
  study::StressRequest request;
  study::StressLimits limits;
  SimulationFlags flags;
  int seeds = 0, jobs = 1;
  bool resume = false;
};

void writeResult(const study::StressResult& result, const std::string& key, const std::string& folder) {
  const auto write = [&](const std::string& suffix, const std::string& text) {
    files::writeFileAtomically(folder + "/stress." + suffix, text);
  };
  write("csv", table::toCsv(result.all));
  write("json", table::toJson(result.all));
  write("txt", table::toText(result.main));
  write("md", table::toMarkdown(result.main));
  write("tex", table::toLatex(result.main, {"tab:stress", {}}));
  draw::drawCharts(result.charts, "Stress: " + key, folder + "/stress.png");
  auto manifest = resources::readManifest(folder + "/manifest.json");
  manifest.files["stress.txt"] = "where methods break; also .md, .tex, .csv, .json";
  manifest.files["stress.png"] = "median error and share of failed runs over what was varied";
  resources::writeManifest(manifest, folder + "/manifest.json");
}

int stressMethods(const Context& context, StressArguments& arguments) {
  auto& request = arguments.request;
  request.settings = simulationConfig(context, arguments.flags);
  if (arguments.seeds > 0) request.seeds = "1.." + std::to_string(arguments.seeds);
  auto suite = study::stressSuite(request);
  const auto sweep = sweep::planSweep(suite.suite);
  sweep::SweepRequest how;
  how.output = context.output;
  how.program = context.programPath();
  how.jobs = arguments.jobs;
  how.resume = arguments.resume;
  how.overwrite = context.overwrite;
  ConsoleProgress progress(context.quiet), cell_progress(true);
  how.cell_progress = &cell_progress;
  const auto outcome = sweep::sweep(sweep, how, context.manifest(), progress);
  for (const auto& line : outcome.lost) std::cerr << "rasterslam: " << line << "\n";
  summary::MergeRequest whole;
  whole.folders = {context.output};
  whole.output = context.output;
  const auto merged = summary::mergeSweep(whole, context.manifest(), core::silentProgress());
  const auto result = study::stress(suite, merged.plan, merged.results, arguments.limits);
  writeResult(result, suite.key, context.output);
  if (context.json)
    std::cout << table::toJson(result.all);
  else
    std::cout << tableText(result.main) << "\ncurves, tables, every run: " << context.output << "\n";
  // Runs that fail are what a stress test is for; only cells that are not there are a failure of its own.
  return static_cast<int>(merged.missing.empty() ? core::ExitCode::kOk : core::ExitCode::kCellsFailed);
}

}  // namespace

void addStress(CLI::App& app, Context& context) {
  auto* command =
      app.add_subcommand("stress", "vary one thing (field of view, noise, people) until methods break");
  auto arguments = std::make_shared<StressArguments>();
  auto& request = arguments->request;
  command
      ->add_option("ground", request.ground,
                   "a plan, a world by name, KIND:seed=3:width_m=40, or a suite's .ini or .yaml")
      ->required();
  command
      ->add_option("--vary", request.vary,
                   "KEY=LOW..HIGH[:STEPS][:log] or KEY=a,b,c: a number of the simulation (lidar.*, "
                   "odometry.*, living.people, ...), or world.KEY of generated buildings")
      ->required();
  command->add_option("--methods", request.methods,
                      "names or .ini files, separated by commas (default: the suite's; of a plan graph, "
                      "icp_exact)");
  command->add_option("--seeds", arguments->seeds, "seeds 1..N (default: the suite's; of a plan 5)")
      ->check(CLI::Range(1, 100000));
  command
      ->add_option("--failure-limit", arguments->limits.failure_rate,
                   "share of failed runs above which a method is broken")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--error-limit", arguments->limits.error,
                   "of the suite's metric (ate_final_m: metres) above which a method is broken; 0: none")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->add_option("-j,--jobs", arguments->jobs, "runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--resume", arguments->resume, "keep the runs that are complete");
  addOutput(command, context, "folder to write");
  command->get_option("--output")->required();
  addSimulationFlags(command, arguments->flags);
  addConfig(command, context);
  command->remove_option(command->get_option("--print-config"));
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam stress office_loop --vary lidar.fov_deg=30..360:6 --seeds 5 -o fov -j 2\n"
      "  rasterslam stress flat --vary living.people=0..20 --methods icp,graph --duration 60 -o people\n"
      "  rasterslam stress office:height_m=12 --vary world.width_m=20..100:5 -o corridor   # so long a "
      "corridor\n"
      "  rasterslam stress configs/suites/smoke.ini --vary odometry.slips_per_m=0.01..10:5:log -o slip");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return stressMethods(context, *arguments); };
  });
}

}  // namespace slam::apps
