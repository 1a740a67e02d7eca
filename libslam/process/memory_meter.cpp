#include "libslam/process/memory_meter.h"

#include <malloc.h>

#include <algorithm>
#include <fstream>

#include "libslam/process/process_memory.h"

namespace slam::process {

void returnFreedMemory() {
  malloc_trim(0);
}

MemoryMeter::MemoryMeter() {
  // What was freed before would be taken without being counted.
  returnFreedMemory();
  std::ofstream("/proc/self/clear_refs") << "5";
  before_mb_ = processMemoryMb("VmRSS");
  files_before_mb_ = processMemoryMb("RssFile");
}

void MemoryMeter::leaveOut(const std::function<void()>& work) {
  const double before_mb = processMemoryMb("VmRSS"), files_before_mb = processMemoryMb("RssFile");
  work();
  const double files_mb = processMemoryMb("RssFile") - files_before_mb;
  before_mb_ += std::max(processMemoryMb("VmRSS") - before_mb - files_mb, 0.0);
}

double MemoryMeter::peakMb() const {
  const double more_mb =
      processMemoryMb("VmHWM") - before_mb_ - (processMemoryMb("RssFile") - files_before_mb_);
  return more_mb < 0 ? 0 : more_mb;
}

}  // namespace slam::process
