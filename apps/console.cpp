#include "apps/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string_view>

#include "libslam/core/error.h"
#include "libslam/files/word_wrap.h"
#include "libslam/table/text.h"

namespace slam::apps {
namespace {

std::atomic<bool> stop_asked{false};

extern "C" void onInterrupt(int signal) {
  stop_asked = true;
  std::signal(signal, SIG_DFL);
}

constexpr std::size_t kTextWidth = 80, kLeastWidth = 40;
constexpr std::size_t kLongestStage = 100;

/// Of a terminal; 80 where nobody knows.
std::size_t columnsOf(int descriptor) {
  if (isatty(descriptor) == 0) return kTextWidth;
  winsize size{};
  if (ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    return std::max<std::size_t>(size.ws_col, kLeastWidth);
  const char* columns = std::getenv("COLUMNS");
  const long number = columns == nullptr ? 0 : std::strtol(columns, nullptr, 10);
  return number > 0 ? std::max(static_cast<std::size_t>(number), kLeastWidth) : kTextWidth;
}

bool isDumb() {
  const char* terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view(terminal) == "dumb";
}

/// "57 s", "12 min", "3.5 h"
std::string durationText(double seconds) {
  char text[32];
  if (seconds < 100)
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  else if (seconds < 6000)
    std::snprintf(text, sizeof text, "%.0f min", seconds / 60);
  else
    std::snprintf(text, sizeof text, "%.1f h", seconds / 3600);
  return text;
}

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
  // Unless nohup has it ignored.
  if (std::signal(SIGHUP, onInterrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  // A file that grows beyond `ulimit -f` is an error of writing, and said so.
  std::signal(SIGXFSZ, SIG_IGN);
}

bool interruptAsked() {
  return stop_asked;
}

ConsoleProgress::ConsoleProgress(bool quiet)
    : quiet_(quiet), is_terminal_(isatty(STDERR_FILENO) != 0 && !isDumb()) {}

void ConsoleProgress::begin(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  stage_ = core::oneLine(stage, kLongestStage);
  is_open_ = true;
  start_ = last_drawn_ = std::chrono::steady_clock::now();
  last_tenth_ = 0;
  log_time_s_ = 0;
}

void ConsoleProgress::update(double fraction, double log_time_s) {
  if (stop_asked) throw core::Interrupted();
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  if (!is_open_) return;
  log_time_s_ = log_time_s;
  if (is_terminal_) {
    if (secondsSince(last_drawn_) > 0.1) drawBar(fraction, log_time_s, false);
    return;
  }
  const int tenth = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * 10);
  if (tenth > last_tenth_ && tenth < 10) std::fprintf(stderr, "%s: %d %%\n", stage_.c_str(), tenth * 10);
  last_tenth_ = std::max(tenth, last_tenth_);
}

void ConsoleProgress::end() {
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  is_open_ = false;
  if (is_terminal_) {
    drawBar(1.0, log_time_s_, true);
    return;
  }
  const double elapsed_s = secondsSince(start_);
  std::fprintf(stderr, "%s: done in %.1f s", stage_.c_str(), elapsed_s);
  if (log_time_s_ > 0) std::fprintf(stderr, ", %.0f x real time", log_time_s_ / std::max(elapsed_s, 1e-3));
  std::fputc('\n', stderr);
}

void ConsoleProgress::drawBar(double fraction, double log_time_s, bool last) {
  constexpr int kWidth = 24;
  const double elapsed_s = std::max(secondsSince(start_), 1e-3);
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kWidth);
  std::string bar(kWidth, ' ');
  std::fill_n(bar.begin(), filled, '=');
  const double left_s = fraction > 0 ? elapsed_s * (1 - fraction) / fraction : 0;
  char state[96];
  std::snprintf(state, sizeof state, " [%s] %3.0f %%  %s %6s %5.0fx", bar.c_str(),
                100 * std::clamp(fraction, 0.0, 1.0), last ? "took" : "left",
                durationText(last ? elapsed_s : left_s).c_str(), log_time_s / elapsed_s);
  // A line that the terminal would break could not be drawn over.
  const auto room = static_cast<int>(columnsOf(STDERR_FILENO)) - 1;
  const int stage_room = std::clamp(room - static_cast<int>(std::string_view(state).size()), 8, 34);
  std::string line = core::oneLine(stage_, static_cast<std::size_t>(stage_room));
  line.resize(static_cast<std::size_t>(stage_room), ' ');
  std::fprintf(stderr, "\r\033[K%.*s", room, (line + state).c_str());
  if (last) std::fputc('\n', stderr);
  std::fflush(stderr);
  last_drawn_ = std::chrono::steady_clock::now();
}

std::size_t terminalWidth() {
  return columnsOf(STDOUT_FILENO);
}

std::string tableText(const table::Table& table) {
  return table::toTextWithin(table, terminalWidth());
}

void printWrapped(const std::string& heading, const std::string& text) {
  const std::string indent(files::letters(heading), ' ');
  for (const auto& line : files::wrapped(text, std::min(terminalWidth(), kTextWidth), heading, indent))
    std::cout << line << "\n";
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size() + 1), ' ');
  return text;
}

}  // namespace slam::apps
