#include "libslam/process/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/process/exit_code.h"

extern char** environ;

namespace slam::process {
namespace {

int waitFor(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

int spawn(const std::vector<std::string>& command, int stdout_fd, const std::string& error_path,
          pid_t& child) {
  std::vector<char*> argv;
  argv.reserve(command.size() + 1);
  for (const auto& word : command) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, stdout_fd, STDOUT_FILENO);
  if (!error_path.empty())
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, error_path.c_str(),
                                     O_WRONLY | O_CREAT | O_TRUNC, 0666);
  std::string parent = std::string(kParentVariable) + "=" + std::to_string(getpid());
  std::vector<char*> environment;
  for (char** variable = environ; *variable != nullptr; ++variable) environment.push_back(*variable);
  environment.push_back(parent.data());
  environment.push_back(nullptr);
  const int error = posix_spawn(&child, argv[0], &actions, nullptr, argv.data(), environment.data());
  posix_spawn_file_actions_destroy(&actions);
  return error;
}

std::array<int, 2> makePipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0)
    throw core::IoError(std::string("no pipe: ") + std::strerror(errno));
  return ends;
}

/// As exec(2) does.
void closeOwnFiles() {
  std::vector<int> files;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd"))
    files.push_back(std::atoi(entry.path().filename().c_str()));
  for (const int file : files) {
    const int flags = fcntl(file, F_GETFD);
    if (flags >= 0 && (flags & FD_CLOEXEC) != 0) close(file);
  }
}

void openAs(int number, const char* path, int flags) {
  const int file = open(path, flags, 0666);
  if (file < 0) throw core::IoError(std::string(path) + ": cannot be opened: " + std::strerror(errno));
  dup2(file, number);
  close(file);
}

/// What the child of a fork does.
[[noreturn]] void workAndExit(const std::function<int()>& work, pid_t parent, int output,
                              const std::string& error_path) {
  int code = 0;
  try {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent) throw core::Interrupted();
    dup2(output, STDOUT_FILENO);
    closeOwnFiles();
    openAs(STDIN_FILENO, "/dev/null", O_RDONLY);
    openAs(STDERR_FILENO, error_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC);
    code = work();
  } catch (const std::exception& error) {
    code = static_cast<int>(process::exitCodeOf(error));
    std::cout << nlohmann::json{{"error", error.what()}, {"exit_code", code}}.dump(
                     -1, ' ', false, nlohmann::json::error_handler_t::replace)
              << "\n";
  }
  std::cout.flush();
  std::fflush(nullptr);
  _exit(code);  // whatever else would be done at the end is the parent's
}

}  // namespace

bool hasOneThread() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::directory_iterator threads("/proc/self/task", error);
  return !error && std::distance(fs::begin(threads), fs::end(threads)) == 1;
}

Worker::Worker(const std::function<int()>& work, const std::string& error_path) {
  if (!hasOneThread()) throw core::ContractError("Worker: a process of several threads is not to be copied");
  const auto ends = makePipe();
  std::cout.flush();
  std::fflush(nullptr);  // or the child would write it again
  const pid_t parent = getpid();
  child_ = fork();
  if (child_ == 0) workAndExit(work, parent, ends[1], error_path);
  close(ends[1]);
  output_end_ = ends[0];
  if (child_ > 0) return;
  const std::string reason = std::strerror(errno);
  close(ends[0]);
  throw core::IoError("no new process: " + reason);
}

Worker::Worker(const std::vector<std::string>& command, const std::string& error_path) {
  const auto ends = makePipe();
  const int error = spawn(command, ends[1], error_path, child_);
  close(ends[1]);
  if (error == 0) {
    output_end_ = ends[0];
    return;
  }
  close(ends[0]);
  throw core::IoError(command[0] + ": cannot be started: " + std::strerror(error));
}

Worker::~Worker() {
  if (child_ > 0) {
    signal(SIGKILL);
    waitFor(child_);
  }
  if (output_end_ >= 0) close(output_end_);
}

Worker::Worker(Worker&& other) noexcept
    : child_(std::exchange(other.child_, -1)),
      output_end_(std::exchange(other.output_end_, -1)),
      out_(std::move(other.out_)) {}

bool Worker::read() {
  std::array<char, 4096> buffer{};
  const ssize_t count = ::read(output_end_, buffer.data(), buffer.size());
  if (count > 0) out_.append(buffer.data(), static_cast<size_t>(count));
  return count > 0 || (count < 0 && errno == EINTR);
}

void Worker::signal(int number) const {
  if (child_ > 0) kill(child_, number);  // -1 would be everybody
}

WorkerResult Worker::wait() {
  const int status = waitFor(std::exchange(child_, -1));
  WorkerResult result;
  result.out = std::move(out_);
  result.killed = WIFSIGNALED(status);
  result.exit_code = result.killed ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
  return result;
}

WorkerResult runWorker(const std::vector<std::string>& command, core::Progress& progress) {
  Worker worker(command);
  try {
    while (true) {
      pollfd waiting{worker.outputEnd(), POLLIN, 0};
      const int ready = poll(&waiting, 1, 100);
      progress.update(-1, 0);
      if (ready > 0 && !worker.read()) return worker.wait();
    }
  } catch (...) {
    worker.signal(SIGINT);
    worker.wait();
    throw;
  }
}

}  // namespace slam::process
