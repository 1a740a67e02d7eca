#include "libslam/files/trial_run.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <exception>
#include <stdexcept>
#include <utility>

namespace slam::files {
namespace {

constexpr int kLongestSilence_ms = 60'000;
constexpr std::uint64_t kAllSurvived = ~std::uint64_t{0};
/// How a copy ends that cannot say how it goes.
constexpr int kUntold = 77;

/// What a copy must not share with this process: signals that are handled here, its output, and the core file
/// of a crash that is expected.
void becomeMortal() {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGINT, SIGTERM, SIGHUP})
    std::signal(number, SIG_DFL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  const int silence = open("/dev/null", O_WRONLY | O_CLOEXEC);
  for (const int number : {STDOUT_FILENO, STDERR_FILENO}) dup2(silence, number);
}

[[noreturn]] void workAndExit(const std::function<void(const TrialRun::Tell&)>& work, pid_t parent,
                              int output) {
  becomeMortal();
  if (getppid() != parent) _exit(kUntold);
  const auto tell = [output](std::uint64_t steps) {
    if (write(output, &steps, sizeof steps) != sizeof steps) _exit(kUntold);
  };
  try {
    work(tell);
  } catch (const std::exception&) {  // the other process meets it, too, and says what it is
  }
  tell(kAllSurvived);
  _exit(0);
}

}  // namespace

TrialRun::TrialRun(const std::function<void(const Tell&)>& work) {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) return;
  const pid_t parent = getpid();
  child_ = fork();
  if (child_ == 0) workAndExit(work, parent, ends[1]);
  close(ends[1]);
  output_ = ends[0];
  if (child_ < 0) end();
}

TrialRun::~TrialRun() {
  end();
}

void TrialRun::end() {
  if (child_ > 0) kill(child_, SIGKILL);
  bury();
}

/// Waits for its end. Returns whether that was a crash.
bool TrialRun::bury() {
  if (output_ >= 0) close(std::exchange(output_, -1));
  if (child_ <= 0) return false;
  int status = 0;
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) {
  }
  child_ = -1;
  return !WIFEXITED(status) || WEXITSTATUS(status) != kUntold;
}

bool TrialRun::survives(std::uint64_t index) {
  while (survived_ <= index && output_ >= 0) {
    pollfd waiting{output_, POLLIN, 0};
    const int ready = poll(&waiting, 1, kLongestSilence_ms);
    if (ready < 0 && errno == EINTR) continue;
    std::uint64_t steps = 0;
    // What is written in pieces of eight bytes is read in such pieces.
    const ssize_t count = ready > 0 ? read(output_, &steps, sizeof steps) : -1;
    if (count == sizeof steps) {
      survived_ = steps;
      continue;
    }
    if (count == 0)
      has_crashed_ = bury();
    else
      end();
  }
  return survived_ > index || !has_crashed_;
}

void doTried(const std::function<void()>& work) {
  if (!TrialRun([&work](const TrialRun::Tell&) { work(); }).survives(0))
    throw std::runtime_error("crashes a copy of this process");
  work();
}

}  // namespace slam::files
