#include <iostream>
#include <memory>
#include <string>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/files/files.h"
#include "libslam/mapping/method_config.h"
#include "libslam/resources/resources.h"
#include "libslam/sessions/diff_maps.h"

namespace slam::apps {
namespace {

struct DiffArguments {
  std::string before, after;
};

int diff(const Context& context, const DiffArguments& arguments) {
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "graph");
  const std::string folder = context.output.empty() ? "changes" : context.output;
  ConsoleProgress progress(context.quiet);
  sessions::diffMaps(arguments.before, arguments.after, config, folder, context.overwrite, context.manifest(),
                     progress);
  std::cout << files::readTextFile(folder + (context.json ? "/changes.json" : "/changes.txt"));
  if (!context.json) std::cout << "\npicture, page, table: " << folder << "\n";
  return 0;
}

}  // namespace

void addDiff(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("diff", "what has changed from one map of a place to a later one");
  auto arguments = std::make_shared<DiffArguments>();
  command
      ->add_option("before", arguments->before,
                   "folder of a run, or its map.simplemap; or a grid: ROS map yaml, .gridmap.gz")
      ->required();
  command->add_option("after", arguments->after, "the later map, of the same kind")->required();
  addOutput(command, context, "folder to write (default changes)");
  addJson(command, context);
  command->footer(
      "Maps of runs are searched for in one another, wherever they begin; grids have to be of one frame.\n"
      "Example:\n"
      "  rasterslam diff monday tuesday -o changes\n"
      "Exit code 4: the maps do not belong together; nothing is written.");
  command->callback([&context, arguments] {
    context.action = [&context, arguments] { return diff(context, *arguments); };
  });
}

}  // namespace slam::apps
