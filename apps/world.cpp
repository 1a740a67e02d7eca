#include "apps/commands.h"

namespace slam::apps {

void addWorld(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("world", "make a floor plan, or check one");
  command->require_subcommand(1);
  addWorldMake(*command, context);
  addWorldCheck(*command, context);
}

}  // namespace slam::apps
