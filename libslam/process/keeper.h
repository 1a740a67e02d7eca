#pragma once
#include <sys/types.h>

#include <cstdint>
#include <string>

namespace slam::process {

/// How a kept program ended; plain bytes, for they come through a pipe.
struct KeptEnd {
  int start_error = 0;        ///< errno when it could not be started
  int status = 0;             ///< as wait(2) gives it
  double cpu_s = 0;           ///< user and system, of it and of all that it left behind
  double peak_memory_mb = 0;  ///< resident, of the largest single process
};

/// A line of /bin/sh, started by a process between it and us, the keeper: a small copy of this one that is
/// the reaper of all below it (prctl(2), PR_SET_CHILD_SUBREAPER). What its programs leave behind, sessions of
/// their own and daemons too, becomes the keeper's child, so that it can be counted and killed: when stop()
/// is called, when the shell ends, and when this process does in whatever way, kill -9 included. What no
/// process can prevent: that a program of the same user kills the keeper itself (the shell dies with it, what
/// it had detached does not), or has another service start something for it.
class Keeper {
 public:
  /// Standard input is empty, standard output and error go to printedEnd(), no core is dumped, and whoever
  /// writes a file beyond `largest_file_bytes` gets SIGXFSZ. Errors: IoError when there is no process or pipe
  /// left.
  Keeper(const std::string& shell_line, const std::string& folder, std::uint64_t largest_file_bytes);
  /// Kills all and waits for it.
  ~Keeper();
  Keeper(const Keeper&) = delete;
  Keeper& operator=(const Keeper&) = delete;

  /// To poll() and read, without blocking, for what the program prints.
  int printedEnd() const { return printed_; }
  /// To poll(): readable when nothing of the program is left.
  int reportEnd() const { return report_; }
  /// Resident, of all below the keeper at this moment.
  double memoryMb() const;
  /// Kills all, without waiting.
  void stop();
  /// Waits until nothing is left. Errors: IoError when the shell could not be started.
  KeptEnd wait();

 private:
  void bury();
  pid_t keeper_ = -1;
  int control_ = -1, report_ = -1, printed_ = -1;
};

}  // namespace slam::process
