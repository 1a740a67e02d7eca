#pragma once
#include <memory>
#include <string>

#include "libslam/logs/log_reader.h"
#include "libslam/rawlogs/rawlog_form.h"

namespace slam::logs {

/// Streams a rawlog that MRPT's own programs read: gzip inside, written beside (files::PendingFile) and
/// renamed by close(), over an older file too. Action form: one CActionCollection with a
/// CActionRobotMovement2D (odometry, MRPT's Gaussian model with its default noise) and one CSensoryFrame per
/// scan; the increment written is T_previous_robot, so the first action is null. Observation form:
/// CObservationOdometry
/// ("ODOMETRY", T_odom_robot) then CObservation2DRangeScan (the entry's label, "LASER" where it has none).
/// The scans of other lidars follow the entry's own, in its frame. A sweep is noted (sweep_note.h) with the
/// first scan that has it. Everything carries the scan's stamp.
/// Without has_odometry: an empty collection, or no CObservationOdometry. Same entries, same bytes. Without
/// close() nothing is left behind. The format holds no minimum range, and the step as the field of view in a
/// float. Errors: IoError with the path, at write() or at the latest at close(). ContractError: fewer than 2
/// beams, odometry that is not finite, a stamp that mrptTicks() refuses, use after close().
class LogWriter {
 public:
  LogWriter(const std::string& path, rawlogs::RawlogForm form);
  ~LogWriter();
  void write(const LogEntry& entry);
  void close();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace slam::logs
