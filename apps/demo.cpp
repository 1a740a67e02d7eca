#include <cstdio>
#include <filesystem>
#include <iostream>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/pages/report_data.h"
#include "libslam/report/html_report.h"
#include "libslam/resources/ini_yaml.h"
#include "libslam/resources/resources.h"
#include "libslam/score/compare.h"

namespace slam::apps {
namespace {

constexpr const char* kWorld = "office_loop";
constexpr double kOriginal_s = 300;
constexpr const char* kRealLog = "2006-01ENE-21-SENA_Telecom Faculty_one_loop_only.rawlog";

score::CompareRequest commonRequest(const Context& context, const std::string& output) {
  score::CompareRequest request;
  request.methods = defaultMethods();
  request.methods_folder = resources::configsFolder() + "/methods";
  request.output = output;
  request.program = context.programPath();
  request.quiet = context.quiet;
  request.seed = context.seed;
  // The default folder is the demo's own; a folder that the user names is respected.
  request.overwrite = context.overwrite || context.output.empty();
  return request;
}

int show(const score::Comparison& comparison, const std::string& title, const std::string& folder,
         core::Progress& progress) {
  const std::string page = folder + "/report.html";
  files::writeFileAtomically(page, report::toHtml(pages::gatherReport(folder, progress)));
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
  simulated.plan_path = resources::resolvePlan(kWorld);
  simulated.record = record::readRecordConfig(files::IniFile());
  int failed = show(score::compare(simulated, context.manifest(), progress),
                    std::string("A robot explores the plan '") + kWorld + "'", simulated.output, progress);

  // The original robot with its own lidar, and what it loses where it has to guess what it was told to do.
  auto original = commonRequest(context, output + "/original");
  original.methods = {"naive", "naive_blind", "naive_wheel", "icp", "graph"};
  original.plan_path = simulated.plan_path;
  original.record = record::readRecordConfig(
      resources::readConfigFile(resources::configsFolder() + "/lidars/thesis_360.ini"));
  original.record.simulation.duration_s = kOriginal_s;
  failed += show(score::compare(original, context.manifest(), progress),
                 "The original robot with the original lidar, thesis_360", original.output, progress);

  const std::string datasets = resources::mrptDatasetsFolder();
  const std::string real_log = datasets.empty() ? "" : datasets + "/" + kRealLog;
  if (real_log.empty() || !std::filesystem::exists(real_log)) {
    std::fprintf(
        stderr,
        "rasterslam: the real log of Debian's package mrpt-common is not installed; its part is left out\n");
  } else {
    auto real = commonRequest(context, output + "/real");
    real.log_path = real_log;
    failed += show(score::compare(real, context.manifest(), progress),
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
