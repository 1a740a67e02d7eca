#include <malloc.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <limits>
#include <new>

#include "apps/commands.h"
#include "apps/help_text.h"
#include "apps/lessons.h"
#include "apps/program.h"
#include "apps/shell_words.h"
#include "libslam/process/exit_code.h"
#include "libslam/resources/manifest.h"

namespace {

int runRasterslam(int argc, char** argv) {
  slam::apps::Context context;
  context.command_line.assign(argv, argv + argc);
  CLI::App app{
      "Probabilistic 2D-lidar SLAM: a robot explores a floor plan, methods map its log, tables say how "
      "well.\n"
      "Start with: rasterslam demo"};
  app.formatter(slam::apps::helpFormatter());
  app.set_version_flag("--version", "rasterslam " + slam::resources::versionText());
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
  slam::apps::addContest(app, context);
  slam::apps::addConvert(app, context);
  slam::apps::addNavigate(app, context);
  slam::apps::addInfo(app, context);
  slam::apps::addGraph(app, context);
  slam::apps::addCheck(app, context);
  slam::apps::addEditing(app, context);
  slam::apps::addMerge(app, context);
  slam::apps::addDiff(app, context);
  slam::apps::addPlot(app, context);
  slam::apps::addPlugin(app, context);
  slam::apps::addNew(app, context);
  slam::apps::addLearn(app, context);
  slam::apps::addRelations(app, context);
  slam::apps::addReport(app, context);
  slam::apps::addView(app, context);
  slam::apps::addWorld(app, context);
  slam::apps::addData(app, context);
  slam::apps::addList(app, context);
  if (const auto answer = slam::apps::answerShell(app, context)) return *answer;
  return slam::apps::runProgram(app, context);
}

/// Memory that was freed is kept for what comes next: a map's size that is given back and asked for anew
/// costs more, page by page, than the scans that wait for it.
void keepFreedMemory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  // What one thread gave back another takes, instead of memory that is touched for the first time.
  mallopt(M_ARENA_MAX, 1);
}

}  // namespace

int main(int argc, char** argv) {
  keepFreedMemory();
  try {
    return runRasterslam(argc, argv);
  } catch (const std::bad_alloc&) {  // before there is a command that could say so
    std::fputs("rasterslam: out of memory\n", stderr);
    return static_cast<int>(slam::core::ExitCode::kFailed);
  }
}
