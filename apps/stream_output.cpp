#include "apps/stream_output.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "apps/commands.h"
#include "apps/printed_text.h"
#include "libslam/core/error.h"
#include "libslam/files/files.h"

namespace slam::apps {
namespace {

/// While one lives, what is printed goes to standard error.
class PrintsAside {
 public:
  PrintsAside() : output_(dup(STDOUT_FILENO)) {
    if (output_ < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
      throw core::IoError("standard output: cannot be written: " + std::string(std::strerror(errno)));
  }
  ~PrintsAside() {
    flushPrintedText();
    dup2(output_, STDOUT_FILENO);
    close(output_);
  }
  PrintsAside(const PrintsAside&) = delete;
  PrintsAside& operator=(const PrintsAside&) = delete;

 private:
  int output_;
};

void copyToOutput(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 1 << 16> buffer;
  while (file.read(buffer.data(), buffer.size()), file.gcount() > 0)
    writeOutput({buffer.data(), static_cast<std::size_t>(file.gcount())});
}

}  // namespace

bool isStandardOutput(const std::string& word) {
  return word == "-" || word == "/dev/stdout" || word == "/dev/fd/1" || word == "/proc/self/fd/1";
}

std::string streamSuffix(const CLI::App& command) {
  const CLI::App* parent = command.get_parent();
  if (parent != nullptr && parent->get_name() == "plot") return ".png";
  if (parent != nullptr && parent->get_name() == "graph" && command.get_name() == "optimise") return ".g2o";
  return command.get_name() == "relations" ? ".relations" : command.get_name() == "report" ? ".html" : "";
}

std::string streamProblem(const CLI::App& command, const std::string& word) {
  return isStandardOutput(word) && streamSuffix(command).empty()
             ? "found standard output, expected a name: what is written is no single stream"
             : "";
}

int withStreamedOutput(const CLI::App& app, Context& context) {
  if (!isStandardOutput(context.output)) return context.action();
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const files::ScratchFolder scratch;
  context.output = scratch / ("output" + streamSuffix(*command));
  int exit_code = 0;
  {
    const PrintsAside aside;
    exit_code = context.action();
  }
  copyToOutput(context.output);
  return exit_code;
}

}  // namespace slam::apps
