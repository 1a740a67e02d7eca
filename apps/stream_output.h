#pragma once
#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace slam::apps {

struct Context;

/// Whether the word behind --output asks for standard output: "-", /dev/stdout and the other names that the
/// system has for it.
bool isStandardOutput(const std::string& word);

/// How the name of what a command writes ends, where that is one file that standard output can take instead;
/// else "".
std::string streamSuffix(const CLI::App& command);

/// What is wrong with the word behind a command's --output, for CLI11; "" when nothing is.
std::string streamProblem(const CLI::App& command, const std::string& word);

/// Does the action of the command that was chosen. Where --output asks for standard output, the file is made
/// in a scratch folder and then copied there, whole or not at all; what the action prints goes to standard
/// error. Errors: IoError when standard output cannot be written.
int withStreamedOutput(const CLI::App& app, Context& context);

}  // namespace slam::apps
