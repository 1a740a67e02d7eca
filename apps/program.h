#pragma once
#include <CLI/CLI.hpp>

#include "apps/commands.h"

namespace slam::apps {

/// Parses the command line that the context holds (`help COMMAND` is `COMMAND --help`), does what it says,
/// and turns errors into one line on standard error (with --json also an object on standard output) and the
/// documented exit code.
int runProgram(CLI::App& app, Context& context);

}  // namespace slam::apps
