#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/commands.h"
#include "apps/help_text.h"
#include "apps/shell_words.h"
#include "libslam/buildings/generator.h"
#include "libslam/explore/explore.h"
#include "libslam/files/files.h"
#include "libslam/mapping/map_builder.h"
#include "libslam/reach/goal_methods.h"
#include "libslam/resources/resources.h"
#include "libslam/score/evaluate.h"
#include "libslam/score/metric_infos.h"
#include "libslam/strategies/strategy.h"

namespace slam::apps {
namespace {

using Entry = std::pair<std::string, std::string>;  // name, meaning

/// The first sentence of the comment that an .ini begins with says what it is.
std::string firstSentence(const std::string& path) {
  std::istringstream lines(files::readTextFile(path));
  std::string sentence;
  for (std::string line; std::getline(lines, line);) {
    const size_t start = line.find_first_not_of("#; ");
    if (line.empty() || (line[0] != '#' && line[0] != ';') || start == std::string::npos) break;
    sentence += (sentence.empty() ? "" : " ") + line.substr(start);
    const size_t stop = sentence.find(". ");
    if (stop != std::string::npos || sentence.back() == '.') return sentence.substr(0, stop);
  }
  return sentence;
}

std::vector<Entry> entriesOf(const std::string& what) {
  std::vector<Entry> entries;
  if (what == "methods" || what == "lidars") {
    const std::string folder = resources::configsFolder() + "/" + what;
    for (const auto& name : resources::namesInFolder(folder, ".ini"))
      entries.emplace_back(name, firstSentence(folder + "/" + name + ".ini"));
  } else if (what == "strategies") {
    for (const auto& name : strategies::strategyNames())
      entries.emplace_back(name, strategies::strategyMeaning(name));
  } else if (what == "navigators") {
    for (const auto& name : reach::goalMethodNames())
      entries.emplace_back(name, reach::goalMethodMeaning(name));
  } else if (what == "buildings") {
    for (const auto& kind : buildings::buildingKinds()) entries.emplace_back(kind.name, kind.meaning);
  } else if (what == "worlds") {
    for (const auto& name : resources::namesInFolder(resources::worldsFolder(), ".yaml")) {
      const auto plan = world::loadPlan(resources::worldsFolder() + "/" + name + ".yaml");
      char size[64];
      std::snprintf(size, sizeof size, "%.1f x %.1f m, %g m a cell", plan.columns * plan.resolution_m,
                    plan.rows * plan.resolution_m, plan.resolution_m);
      entries.emplace_back(name, size);
    }
  } else {
    for (const auto& metric : score::metricInfos()) entries.emplace_back(metric.key, metric.meaning);
    for (const auto& figure : explore::explorationFigureInfos()) entries.push_back(figure);
  }
  return entries;
}

int list(const Context& context, const std::string& what) {
  const auto entries = entriesOf(what);
  if (context.json) {
    auto json = nlohmann::ordered_json::array();
    for (const auto& [name, meaning] : entries) json.push_back({{"name", name}, {"meaning", meaning}});
    std::cout << json.dump(2) << "\n";
    return 0;
  }
  for (const auto& [name, meaning] : entries)
    std::printf("%-20s %s\n", name.c_str(), folded(meaning, 21, 80).c_str());
  return 0;
}

}  // namespace

std::vector<std::string> listedNames(const std::string& what) {
  std::vector<std::string> names;
  for (const auto& entry : entriesOf(what)) names.push_back(entry.first);
  return names;
}

void addList(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand(
      "list", "list methods, strategies, navigators, worlds, buildings, lidars or metrics");
  auto what = std::make_shared<std::string>();
  command
      ->add_option("what", *what, "methods | strategies | navigators | worlds | buildings | lidars | metrics")
      ->required()
      ->check(oneOf({"methods", "strategies", "navigators", "worlds", "buildings", "lidars", "metrics"}));
  addJson(command, context);
  command->footer("Example:\n  rasterslam list methods");
  command->callback([&context, what] { context.action = [&context, what] { return list(context, *what); }; });
}

}  // namespace slam::apps
