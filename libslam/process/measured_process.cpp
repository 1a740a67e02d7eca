#include "libslam/process/measured_process.h"

#include <dirent.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>
#include <thread>

#include "libslam/core/error.h"

extern char** environ;

namespace slam::process {
namespace {

/// The group of a process and its resident pages (proc(5), stat); a process may be gone meanwhile.
bool readStat(const char* process, long& group, long& pages) {
  std::ifstream file("/proc/" + std::string(process) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return false;
  // Behind the name in brackets, which may hold anything: fields 3 (state), 5 (group) and 24 (resident pages).
  const size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return false;
  return std::sscanf(
             text.c_str() + name_end + 1,
             " %*c %*s %ld %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %ld",
             &group, &pages) == 2;
}

double groupMemoryMb(pid_t group) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir("/proc"), closedir);
  if (!folder) return 0;
  double total = 0;
  while (const dirent* entry = readdir(folder.get())) {
    long its_group = 0, pages = 0;
    if (entry->d_name[0] >= '0' && entry->d_name[0] <= '9' && readStat(entry->d_name, its_group, pages) &&
        its_group == group)
      total += static_cast<double>(pages);
  }
  return total * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

/// How a line of the shell is started: in a process group of its own.
class Shell {
 public:
  Shell() {
    posix_spawn_file_actions_init(&actions_);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP);
    posix_spawnattr_setpgroup(&attributes_, 0);
  }
  ~Shell() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&actions_);
  }
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  posix_spawn_file_actions_t* actions() { return &actions_; }

  pid_t start(std::string line) {
    std::string shell = "sh", option = "-c";
    std::array<char*, 4> argv{shell.data(), option.data(), line.data(), nullptr};
    pid_t child = -1;
    const int error = posix_spawn(&child, "/bin/sh", &actions_, &attributes_, argv.data(), environ);
    if (error != 0) throw core::IoError("/bin/sh: cannot be started: " + std::string(std::strerror(error)));
    return child;
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

pid_t spawnGroup(const std::string& shell_line, const std::string& folder, const std::string& printed_path) {
  Shell shell;
  posix_spawn_file_actions_addopen(shell.actions(), STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(shell.actions(), STDOUT_FILENO, printed_path.c_str(),
                                   O_WRONLY | O_CREAT | O_TRUNC, 0666);
  posix_spawn_file_actions_adddup2(shell.actions(), STDOUT_FILENO, STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(shell.actions(), folder.c_str());
  return shell.start(shell_line);
}

/// Kills a process group when this process ends without a word, as by kill -9.
class Watchdog {
 public:
  explicit Watchdog(pid_t group) {
    std::array<int, 2> pipe{};
    if (pipe2(pipe.data(), O_CLOEXEC) != 0)
      throw core::IoError("a pipe cannot be made: " + std::string(std::strerror(errno)));
    our_end_ = pipe[1];
    try {
      Shell shell;
      posix_spawn_file_actions_adddup2(shell.actions(), pipe[0], STDIN_FILENO);
      watchdog_ = shell.start("read word || kill -s KILL -- -" + std::to_string(group) + " 2>/dev/null");
    } catch (...) {
      close(pipe[0]);
      close(our_end_);
      throw;
    }
    close(pipe[0]);
  }
  ~Watchdog() { dismiss(); }
  Watchdog(const Watchdog&) = delete;
  Watchdog& operator=(const Watchdog&) = delete;

  void dismiss() {
    if (watchdog_ < 0) return;
    kill(watchdog_, SIGKILL);
    close(our_end_);
    while (waitpid(watchdog_, nullptr, 0) < 0 && errno == EINTR) {
    }
    watchdog_ = -1;
  }

 private:
  int our_end_ = -1;
  pid_t watchdog_ = -1;
};

/// A running group; nothing of it outlives this, or this process.
class Group {
 public:
  explicit Group(pid_t leader) : leader_(leader) {
    try {
      watchdog_.emplace(leader);
    } catch (...) {
      stop();
      throw;
    }
  }
  ~Group() {
    if (!buried_) stop();
  }
  Group(const Group&) = delete;
  Group& operator=(const Group&) = delete;

  bool hasEnded() const {
    siginfo_t info{};
    // Not yet buried, so that the group's number stays its own until what is left of it is killed.
    return waitid(P_PID, static_cast<id_t>(leader_), &info, WEXITED | WNOHANG | WNOWAIT) == 0 &&
           info.si_pid == leader_;
  }
  /// Kills what still runs.
  void stop() {
    kill(-leader_, SIGKILL);
    if (watchdog_) watchdog_->dismiss();  // as long as the group's number is its own
    while (wait4(leader_, &status_, 0, &usage_) < 0 && errno == EINTR) {
    }
    buried_ = true;
  }
  double memoryMb() const { return groupMemoryMb(leader_); }

  /// REQUIRES stop().
  ProcessOutcome outcome() const {
    ProcessOutcome outcome;
    outcome.killed = WIFSIGNALED(status_);
    outcome.exit_code = outcome.killed ? 128 + WTERMSIG(status_) : WEXITSTATUS(status_);
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    outcome.cpu_s = seconds(usage_.ru_utime) + seconds(usage_.ru_stime);
    outcome.peak_memory_mb = static_cast<double>(usage_.ru_maxrss) / 1024;
    return outcome;
  }

 private:
  pid_t leader_;
  std::optional<Watchdog> watchdog_;
  int status_ = 0;
  rusage usage_{};
  bool buried_ = false;
};

/// Which limit is broken, or "".
std::string brokenLimit(const ProcessLimits& limits, double time_s, double memory_mb) {
  char text[96] = "";
  if (time_s > limits.time_s)
    std::snprintf(text, sizeof text, "it ran for more than %g s", limits.time_s);
  else if (memory_mb > limits.memory_mb)
    std::snprintf(text, sizeof text, "it took %.0f MB, more than %g MB", memory_mb, limits.memory_mb);
  return text;
}

}  // namespace

ProcessOutcome runMeasured(const std::string& shell_line, const std::string& folder,
                           const std::string& printed_path, const ProcessLimits& limits,
                           core::Progress& progress) {
  using Clock = std::chrono::steady_clock;
  Group group(spawnGroup(shell_line, folder, printed_path));
  const auto start = Clock::now();
  const auto since = [](Clock::time_point time) {
    return std::chrono::duration<double>(Clock::now() - time).count();
  };
  auto looked = start;
  auto pause = std::chrono::milliseconds(1);
  while (!group.hasEnded()) {
    progress.update(-1, 0);
    double memory_mb = 0;
    if (since(looked) > 0.2) {
      memory_mb = group.memoryMb();
      looked = Clock::now();
    }
    const std::string limit = brokenLimit(limits, since(start), memory_mb);
    if (!limit.empty()) {
      group.stop();
      auto outcome = group.outcome();
      outcome.limit = limit;
      return outcome;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, std::chrono::milliseconds(50));
  }
  group.stop();
  return group.outcome();
}

}  // namespace slam::process
