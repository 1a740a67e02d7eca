#include "libslam/logs/log_writer.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/serialization/CArchive.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/logs/mrpt_time.h"
#include "libslam/logs/rawlog_stream.h"
#include "libslam/robot/mrpt_types.h"

namespace slam::logs {
namespace {

using mrpt::obs::CActionRobotMovement2D;
using mrpt::serialization::CArchive;

mrpt::Clock::time_point toMrptTime(double time_s) {
  return mrpt::Clock::time_point(mrpt::Clock::duration(mrptTicks(time_s)));
}

mrpt::poses::CPose2D toMrptPose(const core::Pose2& pose) {
  return {pose.x, pose.y, pose.phi};
}

std::shared_ptr<mrpt::obs::CObservation2DRangeScan> toObservation(const LogEntry& entry) {
  auto observation = robot::toMrpt(entry.scan);
  observation->timestamp = toMrptTime(entry.scan.time_s);
  return observation;
}

void writeActionAndFrame(const LogEntry& entry, CArchive& archive) {
  // The form knows no frame without an action before it; an empty collection says that nothing was measured.
  mrpt::obs::CActionCollection actions;
  if (entry.has_odometry) {
    CActionRobotMovement2D movement;
    CActionRobotMovement2D::TMotionModelOptions model;
    model.modelSelection = CActionRobotMovement2D::mmGaussian;
    movement.computeFromOdometry(toMrptPose(entry.T_previous_robot), model);
    movement.timestamp = toMrptTime(entry.scan.time_s);
    actions.insert(movement);
  }
  mrpt::obs::CSensoryFrame frame;
  frame.insert(toObservation(entry));
  archive << actions << frame;
}

void writeObservations(const LogEntry& entry, CArchive& archive) {
  const auto scan = toObservation(entry);
  if (entry.has_odometry) {
    mrpt::obs::CObservationOdometry odometry;
    odometry.sensorLabel = "ODOMETRY";
    odometry.timestamp = toMrptTime(entry.scan.time_s);
    odometry.odometry = toMrptPose(entry.T_odom_robot);
    archive << odometry;
  }
  archive << *scan;
}

void requireWritable(const LogEntry& entry) {
  if (!core::isFinite(entry.T_odom_robot) || !core::isFinite(entry.T_previous_robot))
    throw core::ContractError("LogWriter: odometry that is not finite");
}

std::string requireNoFolder(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    throw core::IoError(path + ": cannot be written: " + std::strerror(EISDIR));
  return path;
}

}  // namespace

struct LogWriter::State {
  State(const std::string& path, RawlogForm rawlog_form)
      : pending(requireNoFolder(path)), stream(pending.path(), path), form(rawlog_form) {}

  core::PendingFile pending;
  PackingStream stream;
  RawlogForm form;
  bool closed = false;
};

LogWriter::LogWriter(const std::string& path, RawlogForm form)
    : state_(std::make_unique<State>(path, form)) {}
LogWriter::~LogWriter() = default;

void LogWriter::write(const LogEntry& entry) {
  if (state_->closed) throw core::ContractError("LogWriter: write() after close()");
  requireWritable(entry);
  auto archive = mrpt::serialization::archiveFrom<mrpt::io::CStream>(state_->stream);
  try {
    if (state_->form == RawlogForm::kActionFrame)
      writeActionAndFrame(entry, archive);
    else
      writeObservations(entry, archive);
  } catch (const std::exception&) {
    // MRPT may have dressed the stream's error in a back trace.
    state_->stream.rethrowFailure();
    throw;
  }
}

void LogWriter::close() {
  if (state_->closed) throw core::ContractError("LogWriter: closed twice");
  state_->closed = true;
  state_->stream.close();
  state_->pending.commit();
}

}  // namespace slam::logs
