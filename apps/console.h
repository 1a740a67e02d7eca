#pragma once
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "libslam/core/progress.h"

namespace slam::apps {

/// Ctrl-C and SIGTERM ask to stop at the next progress report; a second one ends the program at once.
void catchInterrupts();
/// Whether one was asked for, for those who do not report progress.
bool interruptAsked();

/// Progress on standard error: a bar with time left and real-time factor on a terminal, else a line every 10
/// %.
class ConsoleProgress : public core::Progress {
 public:
  explicit ConsoleProgress(bool quiet);
  void begin(const std::string& stage) override;
  void update(double fraction, double log_time_s) override;  ///< throws core::Interrupted after Ctrl-C
  void end() override;

 private:
  void drawBar(double fraction, double log_time_s, bool last);

  std::mutex mutex_;
  bool quiet_, is_terminal_;
  std::string stage_;
  std::chrono::steady_clock::time_point start_, last_drawn_;
  int last_tenth_ = -1;
  double log_time_s_ = 0;
};

/// Words after a heading, broken at 80 columns, further lines under the first; to standard output.
void printWrapped(const std::string& heading, const std::string& text);
/// The text and blanks up to the width, one at least.
std::string padded(std::string text, std::size_t width);

}  // namespace slam::apps
