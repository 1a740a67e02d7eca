#pragma once
#include <CLI/CLI.hpp>
#include <string>

namespace slam::apps {

struct Context;

/// -q, --quiet.
void addQuiet(CLI::App* command, Context& context);
/// With --quiet nothing goes to standard output from here on, but what --json or --print-config ask for.
void muteOutput(const Context& context);
/// One line on standard error for what is no error, after the program's name; none with --quiet.
void note(const Context& context, const std::string& text);

}  // namespace slam::apps
