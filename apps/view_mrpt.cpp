#include "apps/view_mrpt.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string_view>

#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::apps {
namespace {

struct Viewer {
  std::string_view suffix;
  const char *program, *package;
};
constexpr std::array<Viewer, 3> kViewers = {{{".rawlog", "RawLogViewer", "mrpt-apps"},
                                             {".3Dscene", "SceneViewer3D", "mrpt-apps"},
                                             {".simplemap", "robot-map-gui", "mrpt-apps"}}};

const Viewer& viewerOf(const std::string& file) {
  for (const auto& viewer : kViewers)
    if (file.size() > viewer.suffix.size() &&
        file.compare(file.size() - viewer.suffix.size(), std::string::npos, viewer.suffix) == 0)
      return viewer;
  throw core::InputError(
      file + ": is of no kind that a viewer of MRPT's opens, expected .rawlog, .3Dscene or .simplemap");
}

bool isSet(const char* variable) {
  const char* value = std::getenv(variable);
  return value != nullptr && *value != '\0';
}

}  // namespace

void showWithMrpt(const std::string& file) {
  const Viewer& viewer = viewerOf(file);
  files::requireReadableFile(file);
  const std::string program = files::findProgram(viewer.program);
  if (program.empty())
    throw core::IoError(std::string(viewer.program) + ": not found in PATH, needed to show " + file +
                        " (Debian: apt install " + viewer.package + ")");
  if (!isSet("DISPLAY") && !isSet("WAYLAND_DISPLAY"))
    throw core::IoError(std::string(viewer.program) +
                        ": there is no display (DISPLAY is not set), expected a desktop");
  std::string name = viewer.program, argument = file;
  char* const words[] = {name.data(), argument.data(), nullptr};
  execv(program.c_str(), words);
  throw core::IoError(program + ": cannot be started: " + std::strerror(errno));
}

}  // namespace slam::apps
