#include "libslam/run/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "libslam/core/error.h"

extern char** environ;

namespace slam::run {
namespace {

int waitFor(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

pid_t spawn(const std::vector<std::string>& command, int stdout_fd) {
  std::vector<char*> argv;
  for (const auto& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, stdout_fd, STDOUT_FILENO);
  pid_t child = -1;
  const int error = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw core::IoError(command[0] + ": cannot be started: " + std::strerror(error));
  return child;
}

class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw core::IoError(std::string("no pipe: ") + std::strerror(errno));
  }
  ~Pipe() {
    closeWriteEnd();
    close(ends_[0]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  int readEnd() const { return ends_[0]; }
  int writeEnd() const { return ends_[1]; }
  void closeWriteEnd() {
    if (ends_[1] >= 0) close(ends_[1]);
    ends_[1] = -1;
  }

 private:
  std::array<int, 2> ends_{-1, -1};
};

/// Reads to the end of the child's output, reporting in between.
std::string readAll(int fd, core::Progress& progress) {
  std::string text;
  std::array<char, 4096> buffer{};
  while (true) {
    pollfd waiting{fd, POLLIN, 0};
    const int ready = poll(&waiting, 1, 100);
    progress.update(-1, 0);
    if (ready <= 0) continue;
    const ssize_t count = read(fd, buffer.data(), buffer.size());
    if (count > 0)
      text.append(buffer.data(), static_cast<size_t>(count));
    else if (count == 0 || errno != EINTR)
      return text;
  }
}

}  // namespace

WorkerResult runWorker(const std::vector<std::string>& command, core::Progress& progress) {
  Pipe pipe;
  const pid_t child = spawn(command, pipe.writeEnd());
  pipe.closeWriteEnd();
  WorkerResult result;
  try {
    result.out = readAll(pipe.readEnd(), progress);
  } catch (...) {
    kill(child, SIGINT);
    waitFor(child);
    throw;
  }
  const int status = waitFor(child);
  result.killed = WIFSIGNALED(status);
  result.exit_code = result.killed ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return result;
}

}  // namespace slam::run
