#include "apps/commands.h"

namespace slam::apps {

void addWorldMake(CLI::App& world, Context& context) {
  auto* command = world.add_subcommand("make", "draw a building of any size");
  command->callback([&context] { context.action = [] { return 1; }; });
}

}  // namespace slam::apps
