#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>

#include "apps/commands.h"
#include "apps/console.h"
#include "libslam/core/error.h"
#include "libslam/logs/public_data.h"
#include "libslam/resources/resources.h"
#include "libslam/table/table.h"

namespace slam::apps {
namespace {

using logs::PublicData;

nlohmann::ordered_json toJson(const PublicData& data) {
  nlohmann::ordered_json size;
  if (std::isfinite(data.size_mb)) size = data.size_mb;
  return {{"name", data.name},
          {"kind", data.kind},
          {"what", data.what},
          {"by", data.by},
          {"page", data.page},
          {"licence", data.licence},
          {"licence_source", data.licence_source},
          {"format", data.format},
          {"size_mb", size},
          {"truth", data.truth},
          {"odd", data.odd},
          {"fetch", data.fetch},
          {"convert", data.convert},
          {"here", data.here}};
}

/// "key       text" with the text folded at 80 columns.
void print(const std::string& key, const std::string& text) {
  constexpr size_t kIndent = 10, kWidth = 80;
  std::istringstream words(text);
  std::string line = key + std::string(kIndent - std::min(kIndent, key.size()), ' ');
  bool is_empty = true;
  for (std::string word; words >> word;) {
    if (!is_empty && line.size() + 1 + word.size() > kWidth) {
      std::cout << line << "\n";
      line = std::string(kIndent, ' ');
      is_empty = true;
    }
    line += (is_empty ? "" : " ") + word;
    is_empty = false;
  }
  std::cout << line << "\n";
}

void printOne(const PublicData& data, const std::string& note) {
  print("name", data.name + " (" + data.kind + ")");
  print("what", data.what);
  print("by", data.by);
  print("page", data.page);
  print("licence", data.licence + (data.licence_source.empty() ? "" : " (says " + data.licence_source + ")"));
  print("format", data.format);
  std::ostringstream size;
  size << data.size_mb << " MB";
  print("size", std::isfinite(data.size_mb) ? size.str() : "not stated");
  print("truth", data.truth);
  for (const auto& line : data.odd) print("odd", line);
  // Commands are not folded, so that they can be copied.
  for (const auto& line : data.fetch) std::cout << "fetch     " << line << "\n";
  for (const auto& line : data.convert) std::cout << "use       " << line << "\n";
  for (const auto& line : data.here) std::cout << "here      " << line << "\n";
  std::cout << "\n";
  print("note", note);
}

table::Table overview(const logs::PublicDataTable& table) {
  table::Table overview;
  overview.caption = "Public data for 2D-lidar SLAM; nothing is downloaded by this program";
  overview.columns = {{"name", "name", 0},       {"kind", "kind", 0},   {"format", "format", 0},
                      {"licence", "licence", 0}, {"truth", "truth", 0}, {"here", "here", 0}};
  const auto brief = [](const std::string& text) {
    const std::string first = text.substr(0, text.find_first_of("(;:,"));
    return first.substr(0, first.find_last_not_of(' ') + 1);
  };
  for (const auto& data : table.data)
    overview.rows.push_back({data.name, data.kind, brief(data.format), brief(data.licence), brief(data.truth),
                             data.here.empty() ? std::string("") : std::string("yes")});
  overview.notes = {
      table.note, "'rasterslam data NAME' says whose it is, what is odd in it, and how to fetch and use it."};
  return overview;
}

int showData(const Context& context, const std::string& name) {
  const auto table = logs::readPublicData(resources::publicDataFile());
  if (name.empty()) {
    if (context.json) {
      auto list = nlohmann::ordered_json::array();
      for (const auto& data : table.data) list.push_back(toJson(data));
      std::cout << nlohmann::ordered_json{{"note", table.note}, {"data", list}}.dump(2) << "\n";
    } else {
      std::cout << tableText(overview(table));
      for (const auto& data : table.data)
        for (const auto& path : data.here) std::cout << "here: " << path << "\n";
    }
    return 0;
  }
  std::vector<std::string> names;
  for (const auto& data : table.data) names.push_back(data.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw core::InputError("no public data named '" + name + "'" + core::didYouMean(name, names));
  const auto& data = table.data[static_cast<size_t>(found - names.begin())];
  if (context.json)
    std::cout << toJson(data).dump(2) << "\n";
  else
    printOne(data, table.note);
  return 0;
}

}  // namespace

void addData(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("data", "say where public logs and plans can be had; downloads nothing");
  auto name = std::make_shared<std::string>();
  command->add_option("name", *name, "say all of this one; without it, list them all");
  addJson(command, context);
  command->footer(
      "Examples:\n"
      "  rasterslam data\n"
      "  rasterslam data intel\n"
      "  rasterslam data --json");
  command->callback(
      [&context, name] { context.action = [&context, name] { return showData(context, *name); }; });
}

}  // namespace slam::apps
