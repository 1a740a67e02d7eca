#include "libslam/process/keeper.h"

#include <dirent.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <vector>

#include "libslam/core/error.h"

extern char** environ;

namespace slam::process {
namespace {

/// All that the copy needs, made before fork(2): behind it, only functions that signal-safety(7) lists are
/// called.
struct Start {
  std::array<char*, 4> argv;
  const char* folder;
  rlimit file_limit;
  int control, report, printed;
  sigset_t mask;
};

/// Between fork(2) and exec(2) of the shell; errno when that fails.
int becomeShell(const Start& start, pid_t keeper) {
  setpgid(0, 0);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != keeper) return ESRCH;
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGCHLD, SIGXFSZ})
    signal(number, SIG_DFL);
  sigprocmask(SIG_SETMASK, &start.mask, nullptr);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  setrlimit(RLIMIT_FSIZE, &start.file_limit);
  const int nothing = open("/dev/null", O_RDONLY);
  if (nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(start.printed, STDOUT_FILENO) < 0 ||
      dup2(start.printed, STDERR_FILENO) < 0 || chdir(start.folder) != 0)
    return errno;
  close(nothing);
  execve("/bin/sh", start.argv.data(), environ);
  return errno;
}

pid_t forkShell(const Start& start, int& error) {
  const pid_t keeper = getpid();
  std::array<int, 2> failed{};
  if (pipe2(failed.data(), O_CLOEXEC) != 0) {
    error = errno;
    return -1;
  }
  const pid_t shell = fork();
  if (shell == 0) {
    const int why = becomeShell(start, keeper);
    if (write(failed[1], &why, sizeof why) != sizeof why) _exit(126);
    _exit(127);
  }
  if (shell < 0) error = errno;
  close(failed[1]);
  if (shell > 0 && read(failed[0], &error, sizeof error) != sizeof error) error = 0;
  close(failed[0]);
  return shell;
}

/// As exec(2) would, but for the three pipes: who holds ours open keeps others waiting for their end.
void closeOthers(const Start& start) {
  std::array<unsigned, 3> kept{static_cast<unsigned>(start.control), static_cast<unsigned>(start.report),
                               static_cast<unsigned>(start.printed)};
  std::sort(kept.begin(), kept.end());
  unsigned from = 3;
  for (const unsigned file : kept) {
    if (file > from) close_range(from, file - 1, 0);
    from = file + 1;
  }
  close_range(from, ~0U, 0);
}

void killChildren() {
  const int file = open("/proc/thread-self/children", O_RDONLY | O_CLOEXEC);
  if (file < 0) return;
  std::array<char, 4096> text{};
  pid_t child = 0;
  for (ssize_t size; (size = read(file, text.data(), text.size())) > 0;)
    for (ssize_t i = 0; i < size; ++i) {
      const char c = text[static_cast<std::size_t>(i)];
      if (c >= '0' && c <= '9') {
        child = 10 * child + (c - '0');
      } else if (child > 0) {
        kill(child, SIGKILL);
        child = 0;
      }
    }
  close(file);
}

void account(const rusage& usage, KeptEnd& end) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  end.cpu_s += seconds(usage.ru_utime) + seconds(usage.ru_stime);
  end.peak_memory_mb = std::max(end.peak_memory_mb, static_cast<double>(usage.ru_maxrss) / 1024);
}

void onChild(int) {}

/// Until the shell has ended or the other end of `control` closes. The shell stays unburied, so that its
/// group's number stays its own.
void watch(const Start& start, pid_t shell, KeptEnd& end) {
  for (;;) {
    siginfo_t info{};
    while (waitid(P_ALL, 0, &info, WEXITED | WNOHANG | WNOWAIT) == 0 && info.si_pid > 0) {
      if (info.si_pid == shell) return;
      rusage usage{};
      if (wait4(info.si_pid, nullptr, WNOHANG, &usage) > 0) account(usage, end);
      info.si_pid = 0;
    }
    pollfd control{start.control, POLLIN, 0};
    if (ppoll(&control, 1, nullptr, &start.mask) > 0) return;
  }
}

/// Kills the children until there are none: those of the dead become ours.
void killAll(const Start& start, pid_t shell, KeptEnd& end) {
  kill(-shell, SIGKILL);
  for (;;) {
    killChildren();
    int status = 0;
    rusage usage{};
    pid_t ended = 0;
    while ((ended = wait4(-1, &status, WNOHANG, &usage)) > 0) {
      account(usage, end);
      if (ended == shell) end.status = status;
    }
    if (ended < 0 && errno == ECHILD) return;
    const timespec pause{0, 5'000'000};
    ppoll(nullptr, 0, &pause, &start.mask);
  }
}

[[noreturn]] void keep(const Start& start) {
  setpgid(0, 0);
  closeOthers(start);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  prctl(PR_SET_NAME, "keeper");
  for (const int number : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE}) signal(number, SIG_IGN);
  signal(SIGCHLD, onChild);
  KeptEnd end;
  const pid_t shell = forkShell(start, end.start_error);
  if (shell > 0) {
    watch(start, shell, end);
    killAll(start, shell, end);
  }
  _exit(write(start.report, &end, sizeof end) == sizeof end ? 0 : 1);
}

std::string reason() {
  return std::strerror(errno);
}

/// Both ends above those of standard input, output and error.
std::array<int, 2> makePipe() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) throw core::IoError("a pipe cannot be made: " + reason());
  for (int& end : ends)
    if (end <= STDERR_FILENO)
      if (const int moved = fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1); moved >= 0) {
        close(end);
        end = moved;
      }
  return ends;
}

struct ProcessStat {
  long parent = 0, pages = 0;
};

/// The parent of a process and its resident pages (proc(5), stat); a process may be gone meanwhile.
bool readStat(const char* process, ProcessStat& stat) {
  std::ifstream file("/proc/" + std::string(process) + "/stat");
  std::string text;
  if (!std::getline(file, text)) return false;
  // Behind the name in brackets, which may hold anything: fields 3 (state), 4 (parent) and 24 (resident
  // pages).
  const size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return false;
  return std::sscanf(
             text.c_str() + name_end + 1,
             " %*c %ld %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %*s %ld",
             &stat.parent, &stat.pages) == 2;
}

}  // namespace

Keeper::Keeper(const std::string& shell_line, const std::string& folder, std::uint64_t largest_file_bytes) {
  std::string shell = "sh", option = "-c", line = shell_line;
  Start start{{shell.data(), option.data(), line.data(), nullptr}, folder.c_str(), {}, -1, -1, -1, {}};
  getrlimit(RLIMIT_FSIZE, &start.file_limit);
  start.file_limit.rlim_cur = std::min<rlim_t>(start.file_limit.rlim_max, largest_file_bytes);
  start.file_limit.rlim_max = start.file_limit.rlim_cur;
  std::vector<int> files;
  const auto ends = [&] {
    const auto pipe = makePipe();
    files.insert(files.end(), pipe.begin(), pipe.end());
    return pipe;
  };
  try {
    const auto control = ends(), report = ends(), printed = ends();
    start.control = control[0], start.report = report[1], start.printed = printed[1];
    sigset_t child;
    sigemptyset(&child);
    sigaddset(&child, SIGCHLD);
    pthread_sigmask(SIG_BLOCK, &child, &start.mask);
    keeper_ = fork();
    if (keeper_ == 0) keep(start);
    const int error = errno;
    pthread_sigmask(SIG_SETMASK, &start.mask, nullptr);
    if (keeper_ < 0) throw core::IoError("/bin/sh: cannot be started: " + std::string(std::strerror(error)));
    for (const int file : {control[0], report[1], printed[1]}) close(file);
    control_ = control[1], report_ = report[0], printed_ = printed[0];
    fcntl(printed_, F_SETFL, O_NONBLOCK);
  } catch (...) {
    for (const int file : files) close(file);
    throw;
  }
}

Keeper::~Keeper() {
  stop();
  bury();
  close(printed_);
  close(report_);
}

double Keeper::memoryMb() const {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir("/proc"), closedir);
  if (!folder) return 0;
  std::multimap<long, std::pair<long, long>> by_parent;  // the child and its pages
  while (const dirent* entry = readdir(folder.get())) {
    ProcessStat stat;
    if (entry->d_name[0] >= '0' && entry->d_name[0] <= '9' && readStat(entry->d_name, stat))
      by_parent.emplace(stat.parent, std::pair(std::atol(entry->d_name), stat.pages));
  }
  double pages = 0;
  for (std::vector<long> parents{keeper_}; !parents.empty();) {
    const auto [begin, end] = by_parent.equal_range(parents.back());
    parents.pop_back();
    for (auto it = begin; it != end; ++it) {
      pages += static_cast<double>(it->second.second);
      parents.push_back(it->second.first);
    }
  }
  return pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1024.0 * 1024.0);
}

void Keeper::stop() {
  if (control_ >= 0) close(control_);
  control_ = -1;
}

void Keeper::bury() {
  while (keeper_ > 0 && waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) {
  }
  keeper_ = -1;
}

KeptEnd Keeper::wait() {
  KeptEnd end;
  ssize_t size = 0;
  while ((size = read(report_, &end, sizeof end)) < 0 && errno == EINTR) {
  }
  if (size != sizeof end) end.status = SIGKILL;  // somebody killed the keeper, and the shell with it
  bury();
  if (end.start_error != 0)
    throw core::IoError("/bin/sh: cannot be started: " + std::string(std::strerror(end.start_error)));
  return end;
}

}  // namespace slam::process
