#pragma once
#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "libslam/core/progress.h"

namespace slam::process {

/// In the environment of a program that a Worker started: the process that started it. A program of ours that
/// finds it ends with that process (apps/program.cpp), whatever ends that.
inline constexpr const char* kParentVariable = "RASTERSLAM_PARENT";

/// How a child process ended.
struct WorkerResult {
  int exit_code = -1;   ///< 128 + signal when a signal ended it
  std::string out;      ///< its standard output
  bool killed = false;  ///< by a signal
};

/// Whether a copy of this process (fork(2)) is whole: it has the calling thread alone, and no lock that
/// another thread holds is copied with it.
bool hasOneThread();

/// A child process with standard input closed; its standard output is collected. It ends when it closes its
/// standard output and exits. Errors: IoError when it cannot be started.
class Worker {
 public:
  /// A program: command[0] is its path, no shell; kParentVariable is in its environment. error_path: where
  /// its standard error goes; "" shares ours.
  explicit Worker(const std::vector<std::string>& command, const std::string& error_path = "");
  /// A copy of this process that does `work` and ends with the exit code that this returns, without the start
  /// of a program (0.15 s of linking for ours). It has this process's memory but none of the files that
  /// exec(2) would close, and it ends with this process. What `work` throws ends it with
  /// process::exitCodeOf() and one JSON object on its standard output, {"error", "exit_code"}, as `rasterslam
  /// --json` does. REQUIRES hasOneThread() (ContractError).
  Worker(const std::function<int()>& work, const std::string& error_path);
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
  /// Nothing once it was waited for.
  void signal(int number) const;
  /// Waits for it. REQUIRES that it was not called before.
  WorkerResult wait();

 private:
  pid_t child_ = -1;
  int output_end_ = -1;
  std::string out_;
};

/// Runs a Worker that shares standard error to its end. progress.update() is called about ten times a second;
/// when it throws Interrupted the child gets SIGINT, is waited for, and the exception goes on. So one method
/// that crashes or grows cannot take the others with it, and its memory is its own.
WorkerResult runWorker(const std::vector<std::string>& command, core::Progress& progress);

}  // namespace slam::process
