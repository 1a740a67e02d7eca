#include <array>
#include <cstdio>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "apps/commands.h"
#include "apps/console.h"
#include "apps/edited_log.h"
#include "libslam/core/error.h"
#include "libslam/edit/log_edit.h"
#include "libslam/files/files.h"
#include "libslam/mapping/method_config.h"
#include "libslam/resources/resources.h"
#include "libslam/sessions/merge_maps.h"

namespace slam::apps {
namespace {

int mergeLogs(const Context& context, const std::vector<std::string>& logs) {
  if (logs.size() != 2)
    throw core::InputError("merge: found " + std::to_string(logs.size()) + " logs, expected two");
  files::refuseToOverwrite(context.output, context.overwrite);
  ConsoleProgress progress(context.quiet);
  return reportEditedLog(context, edit::mergeLogs(logs[0], logs[1], context.output, progress));
}

std::string lineOf(const sessions::MergedSession& merged, bool is_first) {
  const std::string begin = merged.session.name + ": " + std::to_string(merged.key_frames) + " key frames, ";
  if (is_first) return begin + "its frame is the merged map's";
  const auto& place = merged.place;
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "at x %.2f m, y %.2f m, yaw %.1f deg: %d key frames over %.1f m fit, %.0f nats ahead of the next "
      "best place; %.0f %% of it shares its view with other maps, %.1f %% of that contradicts them",
      place.T_map_part.x, place.T_map_part.y, core::radToDeg(place.T_map_part.phi), place.fitting,
      place.extent_m, place.ahead_nats, 100 * place.shared, 100 * place.contradicted);
  return begin + text.data();
}

int mergeMaps(const Context& context, const std::vector<std::string>& maps) {
  const auto config = mapping::loadMethodConfig(resources::configsFolder() + "/methods", "graph");
  ConsoleProgress progress(context.quiet);
  const auto merged =
      sessions::mergeMaps(maps, config, context.output, context.overwrite, context.manifest(), progress);
  if (context.json) {
    std::cout << files::readTextFile(context.output + "/merge.json");
    return 0;
  }
  bool is_first = true;
  for (const auto& session : merged.sessions)
    printWrapped("", lineOf(session, std::exchange(is_first, false)));
  const auto manifest = resources::readManifest(context.output + "/manifest.json");
  for (const auto& [file, meaning] : manifest.files)
    std::printf("  %-32s %s\n", (context.output + "/" + file).c_str(), meaning.c_str());
  return 0;
}

int merge(const Context& context, const std::vector<std::string>& inputs) {
  std::size_t maps = 0;
  for (const auto& input : inputs) maps += sessions::namesMap(input);
  if (maps == 0) return mergeLogs(context, inputs);
  for (const auto& input : inputs)
    if (!sessions::namesMap(input)) {
      files::requireReadableFile(input);
      throw core::InputError(input + ": found a log among maps, expected logs or maps alone");
    }
  return mergeMaps(context, inputs);
}

}  // namespace

void addMerge(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "merge", "two logs in one, by stamp; or maps of one building in one, wherever they lie");
  auto inputs = std::make_shared<std::vector<std::string>>();
  command
      ->add_option("inputs", *inputs,
                   "two logs of any format that is read here; or two maps or more: folders of runs (graph or "
                   "any other method), or .simplemap files")
      ->required()
      ->expected(2, -1);
  addEditedLog(command, context, "the rawlog, or the folder, to write");
  command->footer(
      "Of two logs each keeps its own order, at equal stamps the second comes second; logs with actions must "
      "not\n"
      "overlap in time. Maps are searched for in one another, and joined where they prove to belong; the "
      "folder\n"
      "that is written can be localised in, and continued.\n"
      "Examples:\n"
      "  rasterslam merge front.rawlog rear.rawlog -o both.rawlog\n"
      "  rasterslam merge monday tuesday -o both        # folders of 'rasterslam run graph ...'\n"
      "Exit code 4: a map belongs to no other of them, or contradicts them; nothing is written.");
  command->callback(
      [&context, inputs] { context.action = [&context, inputs] { return merge(context, *inputs); }; });
}

}  // namespace slam::apps
