#include "libslam/process/measured_process.h"

#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <string_view>

#include "libslam/core/error.h"
#include "libslam/process/keeper.h"

namespace slam::process {
namespace {

using Clock = std::chrono::steady_clock;

double secondsSince(Clock::time_point time) {
  return std::chrono::duration<double>(Clock::now() - time).count();
}

/// What was printed, in bounded memory: the beginning and the end of it.
class Printed {
 public:
  void add(std::string_view text) {
    const std::string_view first = text.substr(0, kKept - begin_.size());
    begin_ += first;
    text.remove_prefix(first.size());
    end_ += text;
    if (end_.size() <= 2 * kKept) return;
    left_out_ += end_.size() - kKept;
    end_.erase(0, end_.size() - kKept);
  }
  std::string text() {
    if (end_.size() > kKept) {
      left_out_ += end_.size() - kKept;
      end_.erase(0, end_.size() - kKept);
    }
    return left_out_ == 0 ? begin_ + end_
                          : begin_ + "\n[" + std::to_string(left_out_) + " bytes left out]\n" + end_;
  }

 private:
  static constexpr std::size_t kKept = 1 << 18;
  std::string begin_, end_;
  std::size_t left_out_ = 0;
};

/// Takes what there is; false when nothing more will come.
bool takePrinted(const Keeper& keeper, Printed& printed) {
  std::array<char, 1 << 16> buffer;
  const ssize_t size = read(keeper.printedEnd(), buffer.data(), buffer.size());
  if (size > 0) printed.add({buffer.data(), static_cast<std::size_t>(size)});
  return size > 0 || (size < 0 && (errno == EAGAIN || errno == EINTR));
}

/// Which limit is broken, or "".
std::string brokenLimit(const ProcessLimits& limits, double time_s, double memory_mb) {
  char text[96] = "";
  if (time_s > limits.time_s)
    std::snprintf(text, sizeof text, "it ran for more than %g s", limits.time_s);
  else if (memory_mb > limits.memory_mb)
    std::snprintf(text, sizeof text, "it took %.0f MB, more than %g MB", memory_mb, limits.memory_mb);
  return text;
}

/// Until nothing of it is left or a limit is broken, which this gives.
std::string waitFor(Keeper& keeper, const ProcessLimits& limits, Printed& printed, core::Progress& progress) {
  const auto start = Clock::now();
  auto told = start, looked = start;
  bool is_printing = true;
  for (;;) {
    std::array<pollfd, 2> ends{{{keeper.reportEnd(), POLLIN, 0}, {keeper.printedEnd(), POLLIN, 0}}};
    poll(ends.data(), is_printing ? 2 : 1, 50);
    if (is_printing && ends[1].revents != 0) is_printing = takePrinted(keeper, printed);
    if (ends[0].revents != 0) return "";
    if (secondsSince(told) > 0.05) {
      progress.update(-1, 0);
      told = Clock::now();
    }
    double memory_mb = 0;
    if (secondsSince(looked) > 0.2) {
      memory_mb = keeper.memoryMb();
      looked = Clock::now();
    }
    if (auto limit = brokenLimit(limits, secondsSince(start), memory_mb); !limit.empty()) return limit;
  }
}

}  // namespace

ProcessOutcome runMeasured(const std::string& shell_line, const std::string& folder,
                           const ProcessLimits& limits, core::Progress& progress) {
  Keeper keeper(shell_line, folder, static_cast<std::uint64_t>(limits.file_mb * 1024 * 1024));
  Printed printed;
  ProcessOutcome outcome;
  outcome.limit = waitFor(keeper, limits, printed, progress);
  keeper.stop();
  const KeptEnd end = keeper.wait();
  for (int i = 0; i < 64; ++i)  // more than a pipe holds; whoever escaped the keeper may still write
    if (!takePrinted(keeper, printed)) break;
  outcome.killed = WIFSIGNALED(end.status);
  outcome.exit_code = outcome.killed ? 128 + WTERMSIG(end.status) : WEXITSTATUS(end.status);
  if (outcome.limit.empty() && (outcome.exit_code == 128 + SIGXFSZ)) {
    char text[96];
    std::snprintf(text, sizeof text, "it wrote a file of more than %g MB", limits.file_mb);
    outcome.limit = text;
  }
  outcome.cpu_s = end.cpu_s;
  outcome.peak_memory_mb = end.peak_memory_mb;
  outcome.printed = printed.text();
  return outcome;
}

}  // namespace slam::process
