#pragma once
#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "apps/commands.h"

namespace slam::apps {

/// What `rasterslam list WHAT` lists: methods, strategies, navigators, worlds, buildings, lidars or metrics.
std::vector<std::string> listedNames(const std::string& what);

/// What the last of the words behind `rasterslam` could be completed to, by the commands and flags of `app`
/// and the names of methods, worlds, lidars, strategies and so on; behind --set the keys of what the words
/// before make of the command, as its --print-config says ("section.key="), and values of those that have
/// few. All begin with that word. Empty: a file's name, or nothing that is known. Parses command lines with
/// `app`, whose options are no longer required afterwards.
std::vector<std::string> completions(CLI::App& app, Context& context, const std::vector<std::string>& words);

/// Writes rasterslam.1, and rasterslam-COMMAND.1 for every command, from the help of `app`. Errors: IoError.
void writeManual(const CLI::App& app, const std::string& folder);

/// `complete WORDS...` and `manual FOLDER`, which shells and the build call: no commands for people. nullopt
/// when the command line is another one; else the exit code.
std::optional<int> answerShell(CLI::App& app, Context& context);

}  // namespace slam::apps
