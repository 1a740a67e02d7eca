#pragma once
#include <string>

#include "libslam/core/progress.h"

namespace slam::process {

/// What a child may take, all its own children with it.
struct ProcessLimits {
  double time_s = 0;      ///< of the clock
  double memory_mb = 0;   ///< resident, summed over its processes; looked at five times a second
  double file_mb = 1000;  ///< of any file that it writes
};

struct ProcessOutcome {
  int exit_code = -1;         ///< 128 + signal when a signal ended it
  bool killed = false;        ///< by a signal
  std::string limit;          ///< which limit it broke and how far, or ""; it was killed then
  double cpu_s = 0;           ///< user and system, of it and of the children that it waited for
  double peak_memory_mb = 0;  ///< resident, of the largest single one of these processes
  std::string printed;  ///< all, or the first and the last 256 KiB and between them how much is left out
};

/// Runs a line of /bin/sh in `folder` with standard input closed and waits for it. Time and memory are the
/// kernel's own account (getrusage(2)). All that it starts, in sessions of their own and as daemons too, is
/// killed (Keeper) when a limit is broken, when progress.update() throws, which it may ten times a second,
/// when this process ends in whatever way, and what is left of it when it ends itself. Errors: IoError when
/// it cannot be started.
ProcessOutcome runMeasured(const std::string& shell_line, const std::string& folder,
                           const ProcessLimits& limits, core::Progress& progress);

}  // namespace slam::process
