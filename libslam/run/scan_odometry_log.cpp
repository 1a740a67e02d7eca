#include "libslam/run/scan_odometry_log.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <deque>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"
#include "libslam/odometry/mrpt_action.h"
#include "libslam/rawlogs/log_motion.h"

namespace slam::run {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CSensoryFrame;
using Object = std::shared_ptr<mrpt::serialization::CSerializable>;

std::string lidarOf(const std::string& path, const std::string& label) {
  logs::LogReader reader(path, label);
  if (!reader.next())
    throw core::InputError(path + ": holds no laser scan, expected scans to take odometry from");
  return reader.sensorLabel();
}

bool isMovement(const mrpt::obs::CAction& action) {
  return dynamic_cast<const mrpt::obs::CActionRobotMovement2D*>(&action) ||
         dynamic_cast<const mrpt::obs::CActionRobotMovement3D*>(&action);
}

/// The log's objects one after the other, with our motions in place of its own.
class ScanOdometryLog {
 public:
  ScanOdometryLog(const std::string& path, const ScanOdometryLogOptions& options)
      : path_(path),
        options_(options),
        odometry_(odometry::makeScanOdometry(options.odometry)),
        source_(logs::openLog(path)) {
    report_.label = lidarOf(path, options.label);
    if (options.form) source_ = rawlogs::inForm(std::move(source_), *options.form, path);
  }

  Object next() {
    while (ready_.empty() && !ended_) {
      if (const auto object = source_->next())
        take(object);
      else
        finish();
    }
    if (ready_.empty()) return nullptr;
    auto object = ready_.front();
    ready_.pop_front();
    ++report_.written;
    return object;
  }
  double fractionRead() const { return source_->fractionRead(); }
  double timeSinceStart() const { return newest_s_ - first_s_.value_or(newest_s_); }
  const ScanOdometryLogReport& report() const { return report_; }

 private:
  void take(const Object& object) {
    if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object))
      takeActions(*actions);
    else if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object))
      takeFrame(frame);
    else if (const auto observation = std::dynamic_pointer_cast<CObservation>(object))
      takeBare(observation);
    else
      ready_.push_back(object);
  }

  void takeActions(const CActionCollection& actions) {
    has_frames_ = true;
    if (const auto increment = rawlogs::incrementOf(actions)) wheels_.add(*increment);
    for (const auto& action : actions) {
      noteTime(action->timestamp);
      if (isMovement(*action))
        ++report_.replaced;
      else
        others_.push_back(std::dynamic_pointer_cast<mrpt::obs::CAction>(action->duplicateGetSmartPtr()));
    }
  }

  void takeFrame(const CSensoryFrame::Ptr& frame) {
    has_frames_ = true;
    requireOneForm();
    auto kept = CSensoryFrame::Create();
    const CObservation2DRangeScan* scan = nullptr;
    for (const auto& observation : *frame) {
      if (isOdometry(*observation)) continue;
      noteTime(observation->timestamp);
      if (!scan) scan = scanOf(*observation);
      kept->insert(observation);
    }
    if (kept->empty() && !frame->empty()) return;  // it held odometry alone
    // A frame without a scan: the motion that has been measured so far is none.
    const auto motion = scan ? update(*scan) : odometry::ScanMotion();
    giveActions(motion, scan);
    ready_.push_back(kept);
  }

  void takeBare(const CObservation::Ptr& observation) {
    if (isOdometry(*observation)) return;
    noteTime(observation->timestamp);
    if (const auto* scan = scanOf(*observation)) {
      has_bare_scans_ = true;
      requireOneForm();
      T_odom_robot_ = T_odom_robot_ * update(*scan).T_previous_current;
      auto reading = CObservationOdometry::Create();
      reading->sensorLabel = "ODOMETRY";
      reading->timestamp = stampOf(scan);
      reading->odometry = mrpt::poses::CPose2D(T_odom_robot_.x, T_odom_robot_.y, T_odom_robot_.phi);
      ready_.push_back(reading);
    }
    ready_.push_back(observation);
  }

  bool isOdometry(const CObservation& observation) {
    const auto* reading = dynamic_cast<const CObservationOdometry*>(&observation);
    if (!reading) return false;
    noteTime(reading->timestamp);
    const auto& pose = reading->odometry;
    if (!has_frames_)
      readings_.add(reading->timestamp.time_since_epoch().count(), {pose.x(), pose.y(), pose.phi()});
    ++report_.replaced;
    return true;
  }

  const CObservation2DRangeScan* scanOf(const CObservation& observation) const {
    const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation);
    return scan && scan->sensorLabel == report_.label ? scan : nullptr;
  }

  odometry::ScanMotion update(const CObservation2DRangeScan& observation) {
    lidar::Scan scan;
    try {
      scan = lidar::fromMrpt(observation);
    } catch (const core::InputError& error) {
      throw core::InputError(path_ + ": " + source_->place() + ": " + error.what());
    }
    scan.time_s = newest_s_;
    if (!has_frames_) wheels_ = readings_.takeUntil(stampOf(&observation).time_since_epoch().count());
    const auto wheels = std::exchange(wheels_, {});
    const auto increment = wheels.has_increment ? std::optional(wheels.T_previous_robot) : std::nullopt;
    const auto motion = odometry_->update(
        scan, options_.commanded ? options_.commanded(scan, increment) : odometry::Commanded());
    ++report_.motions;
    report_.unreliable += motion.reliable ? 0 : 1;
    return motion;
  }

  void giveActions(odometry::ScanMotion motion, const CObservation2DRangeScan* scan) {
    constexpr double kNothing = 1e-12;  // a covariance is positive definite
    if (!scan) motion.covariance = {kNothing, 0, 0, 0, kNothing, 0, 0, 0, kNothing};
    auto actions = odometry::toMrptActions(motion, newest_s_);
    for (auto& action : *actions) action->timestamp = stampOf(scan);
    for (const auto& other : std::exchange(others_, {})) actions->insert(*other);
    ready_.push_back(actions);
  }

  void finish() {
    ended_ = true;
    report_.skipped = source_->skipped();
    if (others_.empty()) return;
    auto actions = CActionCollection::Create();
    for (const auto& other : std::exchange(others_, {})) actions->insert(*other);
    ready_.push_back(actions);
  }

  void noteTime(const mrpt::Clock::time_point& stamp) {
    const auto ticks = stamp.time_since_epoch().count();
    if (ticks == objects::kNoStamp) return;
    newest_ = stamp;
    newest_s_ = objects::secondsFromMrptTicks(ticks);
    if (!first_s_) first_s_ = newest_s_;
  }

  mrpt::Clock::time_point stampOf(const CObservation2DRangeScan* scan) const {
    if (scan && scan->timestamp.time_since_epoch().count() != objects::kNoStamp) return scan->timestamp;
    if (first_s_) return newest_;
    throw core::InputError(path_ + ": " + source_->place() +
                           ": no stamp so far, expected one by the first scan");
  }

  void requireOneForm() const {
    if (has_frames_ && has_bare_scans_)
      throw core::InputError(path_ + ": " + source_->place() + ": frames and bare scans of '" +
                             report_.label +
                             "' in one log, expected one form; give --form action or observation");
  }

  std::string path_;
  const ScanOdometryLogOptions& options_;
  std::unique_ptr<odometry::ScanOdometry> odometry_;
  std::unique_ptr<objects::ObjectSource> source_;
  ScanOdometryLogReport report_;
  std::deque<Object> ready_;
  std::vector<mrpt::obs::CAction::Ptr> others_;  ///< no movements; they wait for their frame
  core::Pose2 T_odom_robot_;
  rawlogs::Motion wheels_;  ///< since the scan before
  rawlogs::BareOdometry readings_;
  mrpt::Clock::time_point newest_;
  double newest_s_ = 0;
  std::optional<double> first_s_;
  bool has_frames_ = false, has_bare_scans_ = false, ended_ = false;
};

}  // namespace

ScanOdometryLogReport writeScanOdometry(const std::string& path, const std::string& output,
                                        const ScanOdometryLogOptions& options, core::Progress& progress) {
  ScanOdometryLog log(path, options);
  const auto sink = logs::createLog(output, logs::LogFormat::kRawlog);
  progress.begin(options.odometry.method + " odometry of " + path);
  constexpr std::uint64_t kBetweenReports = 64;
  while (const auto object = log.next()) {
    sink->write(*object);
    if (log.report().written % kBetweenReports == 0)
      progress.update(log.fractionRead(), log.timeSinceStart());
  }
  sink->close();
  progress.end();
  return log.report();
}

}  // namespace slam::run
