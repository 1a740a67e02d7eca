#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace slam::apps {

/// What `rasterslam list WHAT` lists: methods, strategies, navigators, worlds, buildings, lidars or metrics.
std::vector<std::string> listedNames(const std::string& what);

/// What the last of the words behind `rasterslam` could be completed to, by the commands and flags of `app` and the names of
/// methods, worlds, lidars, strategies and so on; all begin with that word. Empty: a file's name, or nothing that is known.
std::vector<std::string> completions(const CLI::App& app, const std::vector<std::string>& words);

/// Writes rasterslam.1, and rasterslam-COMMAND.1 for every command, from the help of `app`. Errors: IoError.
void writeManual(const CLI::App& app, const std::string& folder);

/// `complete WORDS...` and `manual FOLDER`, which shells and the build call: no commands for people. nullopt when the command
/// line is another one; else the exit code.
std::optional<int> answerShell(const CLI::App& app, const std::vector<std::string>& command_line);

}  // namespace slam::apps
