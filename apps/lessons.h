#pragma once
#include <CLI/CLI.hpp>

#include "apps/commands.h"

namespace slam::apps {

// For those who learn and teach.
void addNew(CLI::App& app, Context& context);
void addLearn(CLI::App& app, Context& context);
void addContest(CLI::App& app, Context& context);

}  // namespace slam::apps
