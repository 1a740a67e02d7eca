#pragma once

namespace slam::results {

/// What a method cost.
struct Cost {
  double mean_ms_per_scan = 0,  ///< with what the method does after the last scan, spread over all
      p99_ms_per_scan = 0;      ///< both: CPU time of the calling thread, without reading the log
  double peak_memory_mb = 0;  ///< growth of the process over its size before the run; NaN when not measurable
  double real_time_factor = 0;  ///< robot's seconds per second of computing
};

}  // namespace slam::results
