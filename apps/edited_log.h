#pragma once
#include <string>
#include <vector>

#include "apps/commands.h"
#include "libslam/edit/log_edit.h"

namespace slam::apps {

/// -o and --json of a command that writes a log of another.
void addEditedLog(CLI::App* command, Context& context, const std::string& what = "the rawlog to write");
/// Says what became of the log's objects, and what was written beside it. Returns the exit code.
int reportEditedLog(const Context& context, const edit::EditCounts& counts,
                    const std::vector<std::string>& beside = {});

}  // namespace slam::apps
