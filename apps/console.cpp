#include "apps/console.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "libslam/core/error.h"

namespace slam::apps {
namespace {

std::atomic<bool> stop_asked{false};

extern "C" void onInterrupt(int signal) {
  stop_asked = true;
  std::signal(signal, SIG_DFL);
}

constexpr std::size_t kTextWidth = 80;

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

void catchInterrupts() {
  std::signal(SIGINT, onInterrupt);
  std::signal(SIGTERM, onInterrupt);
}

bool interruptAsked() {
  return stop_asked;
}

ConsoleProgress::ConsoleProgress(bool quiet) : quiet_(quiet), is_terminal_(isatty(STDERR_FILENO) != 0) {}

void ConsoleProgress::begin(const std::string& stage) {
  const std::lock_guard lock(mutex_);
  stage_ = stage;
  start_ = last_drawn_ = std::chrono::steady_clock::now();
  last_tenth_ = 0;
  log_time_s_ = 0;
}

void ConsoleProgress::update(double fraction, double log_time_s) {
  if (stop_asked) throw core::Interrupted();
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
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
  if (is_terminal_) {
    drawBar(1.0, log_time_s_, true);
    return;
  }
  const double elapsed_s = secondsSince(start_);
  std::fprintf(stderr, "%s: done in %.1f s, %.0f x real time\n", stage_.c_str(), elapsed_s,
               log_time_s_ / std::max(elapsed_s, 1e-3));
}

void ConsoleProgress::drawBar(double fraction, double log_time_s, bool last) {
  constexpr int kWidth = 24;
  const double elapsed_s = std::max(secondsSince(start_), 1e-3);
  const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * kWidth);
  std::string bar(kWidth, ' ');
  std::fill_n(bar.begin(), filled, '=');
  const double left_s = fraction > 0 ? elapsed_s * (1 - fraction) / fraction : 0;
  std::fprintf(stderr, "\r\033[K%-34.34s [%s] %3.0f %%  %s %4.0f s  %.0fx", stage_.c_str(), bar.c_str(),
               100 * std::clamp(fraction, 0.0, 1.0), last ? "took" : "left", last ? elapsed_s : left_s,
               log_time_s / elapsed_s);
  if (last) std::fputc('\n', stderr);
  std::fflush(stderr);
  last_drawn_ = std::chrono::steady_clock::now();
}

void printWrapped(const std::string& heading, const std::string& text) {
  std::istringstream words(text);
  std::string line = heading, word;
  size_t used = heading.size();
  bool is_first = true;
  while (words >> word) {
    if (!is_first && used + 1 + word.size() > kTextWidth) {
      std::cout << line << "\n";
      line.assign(heading.size(), ' ');
      is_first = true;
    }
    line += (is_first ? "" : " ") + word;
    used = line.size();
    is_first = false;
  }
  std::cout << line << "\n";
}

std::string padded(std::string text, std::size_t width) {
  text.resize(std::max(width, text.size() + 1), ' ');
  return text;
}

}  // namespace slam::apps
