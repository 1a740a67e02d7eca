#include "apps/shell_words.h"

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/word_list.h"
#include "libslam/mapping/method_types.h"

namespace slam::apps {
namespace {

bool beginsWith(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

/// The names that a flag or a positional argument wants: what listedNames() calls them, or "".
std::string listOf(const CLI::App& command, const std::string& argument) {
  if (command.get_name() == "navigate" && argument == "--method") return "navigators";
  static const std::map<std::string, std::string> kLists = {
      {"--method", "methods"},      {"--methods", "methods"}, {"--slam", "methods"}, {"--lidar", "lidars"},
      {"--strategy", "strategies"}, {"--plan", "worlds"},     {"method", "methods"}, {"plan", "worlds"},
      {"plans", "worlds"},          {"input", "worlds"},      {"kind", "buildings"}};
  const auto it = kLists.find(argument);
  return it == kLists.end() ? "" : it->second;
}

/// The words that CLI11 takes for an option, where it is told: "TEXT:{carmen,rawlog}".
std::vector<std::string> choicesOf(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const auto open = type.find('{'), close = type.rfind('}');
  if (open == std::string::npos || close == std::string::npos || close < open) return {};
  return files::splitAt(type.substr(open + 1, close - open - 1), ',');
}

/// Values of an option or a positional argument; behind a comma those of the next in a list.
std::vector<std::string> valuesOf(const CLI::App& command, const CLI::Option& option,
                                  const std::string& argument, const std::string& begun) {
  auto names = choicesOf(option);
  if (names.empty() && !listOf(command, argument).empty()) names = listedNames(listOf(command, argument));
  const auto comma = begun.rfind(',');
  if (comma != std::string::npos)
    for (auto& name : names) name = begun.substr(0, comma + 1) + name;
  return names;
}

std::vector<std::string> flagsOf(const CLI::App& command) {
  std::vector<std::string> flags;
  for (const auto* option : command.get_options()) {
    if (option->get_group().empty()) continue;
    for (const auto& name : option->get_lnames()) flags.push_back("--" + name);
    for (const auto& name : option->get_snames()) flags.push_back("-" + name);
  }
  return flags;
}

const CLI::Option* positionalOf(const CLI::App& command, std::size_t index) {
  const CLI::Option* last = nullptr;
  for (const auto* option : command.get_options()) {
    if (!option->get_positional()) continue;
    last = option;
    if (index-- == 0) return option;
  }
  return last != nullptr && last->get_items_expected_max() > 1 ? last : nullptr;
}

std::vector<std::string> subcommandsOf(const CLI::App& command) {
  std::vector<std::string> names;
  for (const auto* subcommand : command.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(subcommand->get_name());
  return names;
}

void requireNothing(CLI::App& app) {
  for (auto* option : app.get_options()) option->required(false);
  for (auto* command : app.get_subcommands([](const CLI::App*) { return true; })) requireNothing(*command);
}

/// What the command of these words prints with --print-config; empty when it cannot say.
nlohmann::json printedConfig(CLI::App& app, Context& context, std::vector<std::string> words) {
  std::ostringstream printed;
  auto* const terminal = std::cout.rdbuf(printed.rdbuf());
  try {
    words.emplace_back("--print-config");
    std::reverse(words.begin(), words.end());  // as CLI11 takes them
    context.action = nullptr;
    app.parse(words);
    context.json = true;
    if (context.action) context.action();
  } catch (const std::exception&) {
    printed.str("");
  }
  std::cout.rdbuf(terminal);
  const auto config = nlohmann::json::parse(printed.str(), nullptr, false);
  return config.is_array() ? config : nlohmann::json::array();
}

/// "section.key=" of all that --set takes behind these words, or "section.key=value" where `begun` has a key
/// whose values are few.
std::vector<std::string> settings(CLI::App& app, Context& context, const std::vector<std::string>& before,
                                  const std::string& begun) {
  requireNothing(app);
  std::vector<std::vector<std::string>> commands = {before};
  if (before.front() == "stress") commands = {{"simulate"}};
  if (before.front() == "compare") {
    commands = {{"simulate"}};
    for (const auto& type : mapping::methodTypes()) commands.push_back({"run", type.name});
  }
  const bool has_key = begun.find('=') != std::string::npos;
  std::vector<std::string> found;
  for (const auto& command : commands)
    for (const auto& row : printedConfig(app, context, command)) {
      const auto setting = row["section"].get<std::string>() + "." + row["key"].get<std::string>() + "=";
      if (!has_key) found.push_back(setting);
      if (has_key && beginsWith(begun, setting))
        for (const auto& choice : row.value("choices", std::vector<std::string>()))
          found.push_back(setting + choice);
    }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Everything that could stand where `begun` stands.
std::vector<std::string> possible(CLI::App& app, Context& context, const std::vector<std::string>& before,
                                  const std::string& begun) {
  const CLI::App* command = &app;
  const CLI::Option* waiting = nullptr;  // a flag before that wants a value
  std::string flag;
  std::size_t positionals = 0;
  for (const auto& word : before) {
    if (waiting != nullptr) {
      waiting = nullptr;
    } else if (beginsWith(word, "-")) {
      const auto* option = command->get_option_no_throw(word);
      if (option != nullptr && option->get_items_expected_max() > 0) waiting = option, flag = word;
    } else if (const auto subcommands = subcommandsOf(*command);
               std::find(subcommands.begin(), subcommands.end(), word) != subcommands.end()) {
      command = command->get_subcommand(word);
      positionals = 0;
    } else {
      ++positionals;
    }
  }
  if (waiting != nullptr && flag == "--set")
    return settings(app, context, {before.begin(), before.end() - 1}, begun);
  if (waiting != nullptr) return valuesOf(*command, *waiting, flag, begun);
  if (beginsWith(begun, "-")) return flagsOf(*command);
  auto words = subcommandsOf(*command);
  const auto* positional = positionalOf(*command, positionals);
  if (!words.empty() || positional == nullptr) return words;
  return valuesOf(*command, *positional, positional->get_single_name(), begun);
}

}  // namespace

std::vector<std::string> completions(CLI::App& app, Context& context, const std::vector<std::string>& words) {
  if (words.empty()) return subcommandsOf(app);
  std::vector<std::string> found;
  for (const auto& word : possible(app, context, {words.begin(), words.end() - 1}, words.back()))
    if (beginsWith(word, words.back())) found.push_back(word);
  return found;
}

std::optional<int> answerShell(CLI::App& app, Context& context) {
  const auto command_line = context.command_line;
  if (command_line.size() < 2) return std::nullopt;
  const std::string& verb = command_line[1];
  try {
    if (verb == "complete") {
      for (const auto& word : completions(app, context, {command_line.begin() + 2, command_line.end()}))
        std::printf("%s\n", word.c_str());
      return 0;
    }
    if (verb == "manual" && command_line.size() == 3) {
      writeManual(app, command_line[2]);
      return 0;
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "rasterslam: %s\n", error.what());
    return 1;
  }
  return std::nullopt;
}

}  // namespace slam::apps
