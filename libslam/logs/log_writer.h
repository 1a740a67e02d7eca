#pragma once
#include <memory>
#include <string>

#include "libslam/logs/log_reader.h"

namespace slam::logs {

enum class RawlogForm { kActionFrame, kObservationOnly };

/// Streams a rawlog that MRPT's own programs read: gzip inside, written beside and renamed by close().
/// Action form: one CActionRobotMovement2D (odometry, Gaussian model) and one CSensoryFrame per scan, the
/// first action null. Observation form: CObservationOdometry ("ODOMETRY", absolute) then
/// CObservation2DRangeScan ("LASER"). Same entries, same bytes. Without close() nothing is left behind.
/// Errors: IoError with the path.
class LogWriter {
 public:
  LogWriter(const std::string& path, RawlogForm form);
  ~LogWriter();
  void write(const LogEntry& entry);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::logs
