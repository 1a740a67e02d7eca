#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <nlohmann/json.hpp>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/exit_code.h"

namespace {

using slam::core::ExitCode;

int code(ExitCode exit_code) {
  return static_cast<int>(exit_code);
}

/// One line on standard error; with --json also an object on standard output, for the program that called us.
int report(const slam::apps::Context& context, const char* message, ExitCode exit_code) {
  std::fprintf(stderr, "rasterslam: %s\n", message);
  if (context.json)
    std::cout << nlohmann::json{{"error", message}, {"exit_code", code(exit_code)}}.dump(
                     -1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  return code(exit_code);
}

}  // namespace

int main(int argc, char** argv) {
  slam::apps::Context context;
  context.command_line.assign(argv, argv + argc);
  CLI::App app{
      "Probabilistic 2D-lidar SLAM: a robot explores a floor plan, methods map its log, tables say how "
      "well.\n"
      "Start with: rasterslam demo"};
  app.set_version_flag("--version", "rasterslam " + slam::core::versionText());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 ok, 1 failed, 2 usage, 3 bad input, 4 a method failed or diverged,\n"
      "5 worse than --gate allows, 6 cells of a sweep failed or are missing, 130 interrupted.\n"
      "'rasterslam COMMAND --help' shows examples.");
  slam::apps::addDemo(app, context);
  slam::apps::addSimulate(app, context);
  slam::apps::addExplore(app, context);
  slam::apps::addRun(app, context);
  slam::apps::addEval(app, context);
  slam::apps::addCompare(app, context);
  slam::apps::addBench(app, context);
  slam::apps::addStress(app, context);
  slam::apps::addTune(app, context);
  slam::apps::addConvert(app, context);
  slam::apps::addNavigate(app, context);
  slam::apps::addInfo(app, context);
  slam::apps::addCheck(app, context);
  slam::apps::addEditing(app, context);
  slam::apps::addPlot(app, context);
  slam::apps::addPlugin(app, context);
  slam::apps::addRelations(app, context);
  slam::apps::addReport(app, context);
  slam::apps::addWorld(app, context);
  slam::apps::addData(app, context);
  slam::apps::addList(app, context);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? code(ExitCode::kOk) : code(ExitCode::kUsage);
  }
  slam::apps::catchInterrupts();
  try {
    return context.action();
  } catch (const std::bad_alloc&) {
    return report(context, "out of memory", ExitCode::kFailed);
  } catch (const std::exception& error) {
    return report(context, error.what(), slam::core::exitCodeOf(error));
  }
}
