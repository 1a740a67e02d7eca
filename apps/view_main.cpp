#include <CLI/CLI.hpp>

#include "apps/commands.h"
#include "apps/help_text.h"
#include "apps/program.h"
#include "apps/view_commands.h"

/// The program behind `rasterslam view`: the same words, with a window.
int main(int argc, char** argv) {
  slam::apps::Context context;
  context.command_line.assign(argv, argv + argc);
  CLI::App app{"The live window of rasterslam: start it as 'rasterslam view'", "rasterslam"};
  app.formatter(slam::apps::helpFormatter());
  app.require_subcommand(1);
  slam::apps::addViewCommands(app, context);
  return slam::apps::runProgram(app, context);
}
