#include "libslam/logs/log_writer.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/sweep_note.h"
#include "libslam/rawlogs/rawlog_stream.h"

namespace slam::logs {
namespace {

/// The scans of an entry, each as an observation, and what is new to say of their sweeps.
std::vector<mrpt::obs::CObservation::Ptr> observationsOf(const LogEntry& entry,
                                                         std::map<std::string, std::string>& notes) {
  std::vector<mrpt::obs::CObservation::Ptr> scans, news;
  const auto ticks = objects::mrptTicks(entry.scan.time_s);
  const auto add = [&](const std::string& lidar, const lidar::Scan& scan,
                       const std::optional<lidar::Sweep>& sweep) {
    auto observation = lidar::toMrpt(scan);
    observation->timestamp = mrpt::Clock::time_point(mrpt::Clock::duration(objects::mrptTicks(scan.time_s)));
    if (!lidar.empty()) observation->sensorLabel = lidar;
    scans.push_back(observation);
    if (!sweep) return;
    const std::string text = objects::formatSweepNote({observation->sensorLabel, *sweep});
    if (std::exchange(notes[observation->sensorLabel], text) != text)
      news.push_back(objects::makeComment(text, ticks));
  };
  add(entry.lidar, entry.scan, entry.sweep);
  for (const auto& other : entry.others) add(other.lidar, other.scan, other.sweep);
  scans.insert(scans.end(), news.begin(), news.end());
  return scans;
}

void writeActionAndFrame(const LogEntry& entry, std::map<std::string, std::string>& notes,
                         objects::ObjectSink& sink) {
  // The form knows no frame without an action before it; an empty collection says that nothing was measured.
  mrpt::obs::CActionCollection actions;
  if (entry.has_odometry)
    actions.insert(objects::wheelAction(entry.T_previous_robot, objects::mrptTicks(entry.scan.time_s)));
  mrpt::obs::CSensoryFrame frame;
  for (const auto& observation : observationsOf(entry, notes)) frame.insert(observation);
  sink.write(actions);
  sink.write(frame);
}

void writeObservations(const LogEntry& entry, std::map<std::string, std::string>& notes,
                       objects::ObjectSink& sink) {
  auto observations = observationsOf(entry, notes);
  if (entry.has_odometry)
    sink.write(*objects::makeOdometry(entry.T_odom_robot, objects::mrptTicks(entry.scan.time_s),
                                      objects::kOdometryLabel));
  // A note stands before the scan that it is true of.
  std::stable_partition(observations.begin(), observations.end(), [](const auto& observation) {
    return dynamic_cast<const mrpt::obs::CObservationComment*>(observation.get()) != nullptr;
  });
  for (const auto& observation : observations) sink.write(*observation);
}

void requireWritable(const LogEntry& entry) {
  if (!core::isFinite(entry.T_odom_robot) || !core::isFinite(entry.T_previous_robot))
    throw core::ContractError("LogWriter: odometry that is not finite");
}

}  // namespace

struct LogWriter::State {
  rawlogs::RawlogSink sink;
  rawlogs::RawlogForm form;
  std::map<std::string, std::string> sweep_notes = {};  ///< the last by label
};

LogWriter::LogWriter(const std::string& path, rawlogs::RawlogForm form)
    : state_(new State{rawlogs::RawlogSink(path), form}) {}
LogWriter::~LogWriter() = default;

void LogWriter::write(const LogEntry& entry) {
  requireWritable(entry);
  if (state_->form == rawlogs::RawlogForm::kActionFrame)
    writeActionAndFrame(entry, state_->sweep_notes, state_->sink);
  else
    writeObservations(entry, state_->sweep_notes, state_->sink);
}

void LogWriter::close() {
  state_->sink.close();
}

}  // namespace slam::logs
