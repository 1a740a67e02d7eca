#include "libslam/logs/log_writer.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include "libslam/core/error.h"
#include "libslam/logs/mrpt_objects.h"
#include "libslam/logs/mrpt_time.h"
#include "libslam/logs/rawlog_stream.h"
#include "libslam/robot/mrpt_types.h"

namespace slam::logs {
namespace {

std::shared_ptr<mrpt::obs::CObservation2DRangeScan> toObservation(const LogEntry& entry) {
  auto observation = robot::toMrpt(entry.scan);
  observation->timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(mrptTicks(entry.scan.time_s)));
  return observation;
}

void writeActionAndFrame(const LogEntry& entry, ObjectSink& sink) {
  // The form knows no frame without an action before it; an empty collection says that nothing was measured.
  mrpt::obs::CActionCollection actions;
  if (entry.has_odometry) actions.insert(wheelAction(entry.T_previous_robot, mrptTicks(entry.scan.time_s)));
  mrpt::obs::CSensoryFrame frame;
  frame.insert(toObservation(entry));
  sink.write(actions);
  sink.write(frame);
}

void writeObservations(const LogEntry& entry, ObjectSink& sink) {
  const auto scan = toObservation(entry);
  if (entry.has_odometry)
    sink.write(*makeOdometry(entry.T_odom_robot, mrptTicks(entry.scan.time_s), kOdometryLabel));
  sink.write(*scan);
}

void requireWritable(const LogEntry& entry) {
  if (!core::isFinite(entry.T_odom_robot) || !core::isFinite(entry.T_previous_robot))
    throw core::ContractError("LogWriter: odometry that is not finite");
}

}  // namespace

struct LogWriter::State {
  RawlogSink sink;
  RawlogForm form;
};

LogWriter::LogWriter(const std::string& path, RawlogForm form) : state_(new State{RawlogSink(path), form}) {}
LogWriter::~LogWriter() = default;

void LogWriter::write(const LogEntry& entry) {
  requireWritable(entry);
  if (state_->form == RawlogForm::kActionFrame)
    writeActionAndFrame(entry, state_->sink);
  else
    writeObservations(entry, state_->sink);
}

void LogWriter::close() {
  state_->sink.close();
}

}  // namespace slam::logs
