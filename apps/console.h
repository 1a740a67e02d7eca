#pragma once
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

#include "libslam/core/progress.h"
#include "libslam/table/table.h"

namespace slam::apps {

/// Ctrl-C and SIGTERM ask to stop at the next progress report; a second one ends the program at once.
void catchInterrupts();
/// Whether one was asked for, for those who do not report progress.
bool interruptAsked();

/// Progress on standard error: a bar with time left and real-time factor on a terminal, else a line every 10
/// %. Nothing of ours has colour (so there is nothing that NO_COLOR would have to turn off); a terminal that
/// can do nothing (TERM=dumb) gets lines.
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
  bool is_open_ = false;  ///< between begin() and end(); outside them nothing is drawn
  std::string stage_;
  std::chrono::steady_clock::time_point start_, last_drawn_;
  int last_tenth_ = -1;
  double log_time_s_ = 0;
};

/// Columns of the terminal that standard output is: what it says itself, else the variable COLUMNS, at least
/// 40; 80 where standard output is none, or neither says.
std::size_t terminalWidth();
/// For standard output, in its width. Files are written by table::toText(), whatever the terminal.
std::string tableText(const table::Table& table);
/// Words after a heading, broken at the terminal's width, 80 at most, further lines under the first; to
/// standard output.
void printWrapped(const std::string& heading, const std::string& text);
/// The text and blanks up to the width, one at least.
std::string padded(std::string text, std::size_t width);

}  // namespace slam::apps
