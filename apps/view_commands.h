#pragma once
#include <CLI/CLI.hpp>

#include "apps/commands.h"

namespace slam::apps {

/// `view` with its subcommands, in the program that has the window.
void addViewCommands(CLI::App& app, Context& context);

}  // namespace slam::apps
