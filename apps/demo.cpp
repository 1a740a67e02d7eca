#include <cstdio>
#include <filesystem>
#include <iostream>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/report/html_report.h"
#include "libslam/run/compare.h"
#include "libslam/run/report_data.h"
#include "libslam/run/resources.h"

namespace slam::apps {
namespace {

constexpr const char* kWorld = "office_loop";
constexpr double kFounding_s = 300;
constexpr const char* kRealLog = "2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";

run::CompareRequest commonRequest(const Context& context, const std::string& output) {
  run::CompareRequest request;
  request.methods = defaultMethods();
  request.methods_folder = run::configsFolder() + "/methods";
  request.output = output;
  request.program = context.programPath();
  request.quiet = context.quiet;
  request.seed = context.seed;
  // The default folder is the demo's own; a folder that the user names is respected.
  request.overwrite = context.overwrite || context.output.empty();
  return request;
}

int show(const run::Comparison& comparison, const std::string& title, const std::string& folder,
         core::Progress& progress) {
  const std::string page = folder + "/report.html";
  core::writeFileAtomically(page, report::toHtml(run::gatherReport(folder, progress)));
  std::cout
      << "\n== " << title << "\n\n"
      << tableText(comparison.accuracy) << "\n"
      << tableText(comparison.cost) << "\nOpen " << page
      << " in a browser: maps, errors, replay. Each method's folder holds its map for MRPT's viewers.\n";
  return comparison.failed;
}

int demo(const Context& context) {
  const std::string output = context.output.empty() ? "rasterslam-demo" : context.output;
  ConsoleProgress progress(context.quiet);

  auto simulated = commonRequest(context, output + "/simulated");
  simulated.plan_path = run::resolvePlan(kWorld);
  simulated.record = run::readRecordConfig(core::IniFile());
  int failed = show(run::compare(simulated, context.manifest(), progress),
                    std::string("A robot explores the plan '") + kWorld + "'", simulated.output, progress);

  // The founding robot with its own lidar, and what it loses where it has to guess what it was told to do.
  auto founding = commonRequest(context, output + "/founding");
  founding.methods = {"naive", "naive_blind", "naive_wheel", "icp", "graph"};
  founding.plan_path = simulated.plan_path;
  founding.record =
      run::readRecordConfig(core::IniFile::load(run::configsFolder() + "/lidars/thesis_360.ini"));
  founding.record.simulation.duration_s = kFounding_s;
  failed += show(run::compare(founding, context.manifest(), progress),
                 "The founding robot with the founding lidar, thesis_360", founding.output, progress);

  const std::string datasets = run::mrptDatasetsFolder();
  const std::string real_log = datasets.empty() ? "" : datasets + "/" + kRealLog;
  if (real_log.empty() || !std::filesystem::exists(real_log)) {
    std::fprintf(
        stderr,
        "rasterslam: the real log of Debian's package mrpt-common is not installed; its part is left out\n");
  } else {
    auto real = commonRequest(context, output + "/real");
    real.log_path = real_log;
    failed += show(run::compare(real, context.manifest(), progress),
                   "A real robot in Malaga (MRPT's sample log)", real.output, progress);
  }
  std::cout << "\nNext: rasterslam simulate YOUR_PLAN.png -o run.rawlog && rasterslam compare run.rawlog\n";
  return static_cast<int>(failed ? core::ExitCode::kMethodFailed : core::ExitCode::kOk);
}

}  // namespace

void addDemo(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "demo", "the main job in a minute: simulate, map with several methods, score; then a real log");
  addOutput(command, context, "folder to write (default rasterslam-demo, replaced each time)");
  addSeed(command, context);
  command->footer("Example:\n  rasterslam demo -o my-demo");
  command->callback([&context] { context.action = [&context] { return demo(context); }; });
}

}  // namespace slam::apps
