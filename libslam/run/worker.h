#pragma once
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

/// Runs a program (argv[0] is its path, no shell) with standard input closed and standard error shared, and
/// waits for it. progress.update() is called about ten times a second; when it throws Interrupted the child
/// gets SIGINT, is waited for, and the exception goes on. So one method that crashes or grows cannot take the
/// others with it, and its memory is its own. Errors: IoError when the program cannot be started.
WorkerResult runWorker(const std::vector<std::string>& command, core::Progress& progress);

}  // namespace slam::run
