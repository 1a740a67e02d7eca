#pragma once
#include <sys/types.h>

#include <string>
#include <vector>

#include "libslam/core/progress.h"

namespace slam::run {

/// How a child process ended.
struct WorkerResult {
  int exit_code = -1;   ///< 128 + signal when a signal ended it
  std::string out;      ///< its standard output
  bool killed = false;  ///< by a signal
};

/// A child process (argv[0] is the path of its program, no shell) with standard input closed; its standard output is
/// collected. It ends when it closes its standard output and exits. Errors: IoError when it cannot be started.
class Worker {
 public:
  /// error_path: where its standard error goes; "" shares ours.
  explicit Worker(const std::vector<std::string>& command, const std::string& error_path = "");
  /// Kills and buries a child that still runs.
  ~Worker();
  Worker(Worker&& other) noexcept;
  Worker& operator=(Worker&& other) = delete;
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// To poll() for what it writes, and for its end.
  int outputEnd() const { return output_end_; }
  /// Takes what it has written, waiting for it when there is nothing yet; false at the end.
  bool read();
  void signal(int number) const;
  /// Waits for it. REQUIRES that it was not called before.
  WorkerResult wait();

 private:
  pid_t child_ = -1;
  int output_end_ = -1;
  std::string out_;
};

/// Runs a Worker that shares standard error to its end. progress.update() is called about ten times a second; when it
/// throws Interrupted the child gets SIGINT, is waited for, and the exception goes on. So one method that crashes or grows
/// cannot take the others with it, and its memory is its own.
WorkerResult runWorker(const std::vector<std::string>& command, core::Progress& progress);

}  // namespace slam::run
