#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "apps/view_mrpt.h"
#include "libslam/core/error.h"

namespace slam::apps {
namespace {

/// Becomes the program with the window, with the same words. A program of its own, because a window's
/// libraries would make every start of this one slower.
int becomeViewer(const Context& context) {
  const std::string viewer =
      (std::filesystem::path(context.programPath()).parent_path() / "rasterslam-view").string();
  std::vector<char*> arguments;
  for (const auto& word : context.command_line) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  execv(viewer.c_str(), arguments.data());
  throw core::IoError(viewer + ": " + std::strerror(errno) +
                      "; it is built where MRPT's GUI library is (Debian: libmrpt-gui-dev)");
}

}  // namespace

void addView(CLI::App& app, Context& context) {
  auto* command = app.add_subcommand("view", "watch a robot live in a window, or drive it by hand");
  command->set_help_flag();  // the viewer's own
  command->prefix_command();
  auto file = std::make_shared<std::string>();
  command->add_option("--mrpt", *file,
                      "show a file in MRPT's own viewer instead: .rawlog, .3Dscene, .simplemap");
  command->callback([&context, file] {
    context.action = [&context, file] {
      if (!file->empty()) showWithMrpt(*file);
      return becomeViewer(context);
    };
  });
}

}  // namespace slam::apps
