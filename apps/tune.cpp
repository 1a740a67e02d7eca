#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/study/tune.h"

namespace slam::apps {
namespace {

int tuneMethod(const Context& context, study::TuneRequest& request) {
  request.seed = context.seed;
  request.output = context.output;
  request.program = context.programPath();
  request.overwrite = context.overwrite;
  ConsoleProgress progress(context.quiet), cell_progress(true);
  request.cell_progress = &cell_progress;
  const auto result = study::tune(request, context.manifest(), progress);
  for (const auto& line : result.lost) std::cerr << "rasterslam: " << line << "\n";
  if (context.json) {
    const auto parsed = [](const table::Table& table) {
      return nlohmann::ordered_json::parse(table::toJson(table));
    };
    std::cout << nlohmann::ordered_json{{"verdict", result.verdict},
                                        {"is_better", result.is_better},
                                        {"tuned", result.tuned_path},
                                        {"candidates", parsed(result.candidates)},
                                        {"sensitivity", parsed(result.sensitivity)},
                                        {"held_out", parsed(result.held_out)}}
                     .dump(2)
              << "\n";
  } else {
    std::cout << tableText(result.sensitivity) << "\n";
    if (!result.held_out.rows.empty()) std::cout << tableText(result.held_out) << "\n";
    std::cout << result.verdict << "\nconfiguration: " << result.tuned_path << "\n";
  }
  return static_cast<int>(result.lost.empty() ? core::ExitCode::kOk : core::ExitCode::kCellsFailed);
}

}  // namespace

void addTune(CLI::App& app, Context& context) {
  auto* command =
      app.add_subcommand("tune", "search a method's parameters, and judge them on held-out worlds");
  auto request = std::make_shared<study::TuneRequest>();
  command->add_option("method", request->method, "a method by name, or an .ini file")->required();
  command->add_option("suite", request->suite_path, "a suite with a section [tune]: configs/suites/tune.ini")
      ->required();
  command->add_option("--budget", request->budget, "training runs at most")
      ->required()
      ->check(CLI::Range(1, 10000000));
  command->add_option("-j,--jobs", request->jobs, "runs side by side")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command->add_flag("--resume", request->resume, "keep the runs that are complete");
  addSeed(command, context);
  addOutput(command, context, "folder to write");
  command->get_option("--output")->required();
  addJson(command, context);
  command->footer(
      "Exit codes: 0 done, whatever the verdict; 6 runs are missing (--resume); 130 interrupted.\n"
      "Examples:\n"
      "  rasterslam tune graph configs/suites/tune.ini --budget 200 -o tuned -j 2\n"
      "  rasterslam tune icp configs/suites/tune.ini --budget 200 -o tuned_icp --resume");
  command->callback([&context, request] {
    context.action = [&context, request] { return tuneMethod(context, *request); };
  });
}

}  // namespace slam::apps
