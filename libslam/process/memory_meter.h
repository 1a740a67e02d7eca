#pragma once
#include <functional>

namespace slam::process {

/// Peak memory of this process from construction on, over its size then. Linux lets a process forget its own
/// peak. Pages of files that have come meanwhile (mostly code that ran for the first time) are not counted:
/// how many those are depends on what the process did before.
class MemoryMeter {
 public:
  MemoryMeter();
  /// Does work whose memory is not counted, as long as it stays in use.
  void leaveOut(const std::function<void()>& work);
  /// NaN where the system does not say.
  double peakMb() const;

 private:
  double before_mb_, files_before_mb_;
};

/// Gives back to the system what this process has freed, before another large piece of work.
void returnFreedMemory();

}  // namespace slam::process
