#include "apps/quiet.h"

#include <fcntl.h>
#include <unistd.h>

#include <cstdio>

#include "apps/commands.h"

namespace slam::apps {

void addQuiet(CLI::App* command, Context& context) {
  command->add_flag("-q,--quiet", context.quiet, "print nothing but errors (and what --json asks for)");
}

void muteOutput(const Context& context) {
  if (!context.quiet || context.json || context.print_config) return;
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  close(nowhere);
}

void note(const Context& context, const std::string& text) {
  if (!context.quiet) std::fprintf(stderr, "rasterslam: %s\n", text.c_str());
}

}  // namespace slam::apps
