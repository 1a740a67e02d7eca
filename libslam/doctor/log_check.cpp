#include "libslam/doctor/log_check.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

#include "libslam/calibration/motion_series.h"
#include "libslam/calibration/odometry_tally.h"
#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/doctor/log_visitor.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/logs/log_format.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"
#include "libslam/objects/sweep_note.h"
#include "libslam/rawlogs/log_motion.h"

namespace slam::doctor {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;

constexpr std::size_t kMostLidars = 8, kMostOdometers = 8;
constexpr double kReadingsPerScan = 8;  // odometry that comes oftener is thinned

std::optional<double> stampOf(const mrpt::Clock::time_point& stamp) {
  const auto ticks = stamp.time_since_epoch().count();
  if (ticks == objects::kNoStamp) return std::nullopt;
  return objects::secondsFromMrptTicks(ticks);
}

std::string className(const mrpt::rtti::CObject& object) {
  const std::string name = object.GetRuntimeClass()->className;
  return name.substr(name.rfind(':') + 1);
}

/// Odometry of either form as absolute poses: an action's increment is complete when its frame's first
/// observation comes.
class OdometryReader {
 public:
  struct Reading {
    std::string stream;
    std::optional<double> time_s;
    core::Pose2 T_odom_robot;
  };
  void takeActions(const CActionCollection& actions) {
    const auto increment = rawlogs::incrementOf(actions);
    if (!increment || !core::isFinite(*increment)) return;
    pose_ = pose_ * *increment;
    is_pending_ = true;
  }
  /// What the observation says of the odometry, or completes.
  std::optional<Reading> take(const CObservation& observation, bool is_in_frame) {
    if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation)) {
      const auto& pose = odometry->odometry;
      const core::Pose2 T_odom_robot{pose.x(), pose.y(), pose.phi()};
      if (!core::isFinite(T_odom_robot)) return std::nullopt;
      return Reading{odometry->sensorLabel, stampOf(odometry->timestamp), T_odom_robot};
    }
    if (!is_in_frame || !is_pending_) return std::nullopt;
    is_pending_ = false;
    return Reading{calibration::kActionStream, stampOf(observation.timestamp), pose_};
  }

 private:
  core::Pose2 pose_;
  bool is_pending_ = false;
};

/// The stamps of a log's objects, stream by stream.
class StreamSurvey {
 public:
  /// The stamp that counts.
  std::optional<double> takeObservation(const CObservation& observation) {
    // Parameters and remarks may carry the clock of whoever wrote them.
    const bool is_text = dynamic_cast<const mrpt::obs::CObservationComment*>(&observation) != nullptr;
    const auto time_s = is_text ? std::nullopt : stampOf(observation.timestamp);
    tallies_.add(className(observation), observation.sensorLabel, time_s);
    return time_s;
  }
  void takeActions(const CActionCollection& actions) {
    std::optional<double> time_s;
    for (const auto& action : actions)
      if (!time_s) time_s = stampOf(action->timestamp);
    tallies_.add(className(actions), "", time_s);
  }
  void takeOther(const mrpt::serialization::CSerializable& object) {
    tallies_.add(className(object), "", std::nullopt);
  }
  std::vector<calibration::StreamFigures> figures() const { return tallies_.figures(); }

 private:
  calibration::StreamTallies tallies_;
};

/// The first reading of a log: stamps and ranges.
class Survey : public LogVisitor {
 public:
  explicit Survey(LogFigures& figures) : figures_(figures) {}

  void takeObservation(const CObservation& observation, bool is_in_frame) override {
    (is_in_frame ? figures_.has_frames : figures_.has_bare_observations) = true;
    const auto time_s = streams_.takeObservation(observation);
    takeStamp(time_s);
    figures_.has_truth |= observation.sensorLabel == objects::kTruthLabel;
    const auto reading = odometry_.take(observation, is_in_frame);
    if (reading && (odometry_tallies_.size() < kMostOdometers || odometry_tallies_.count(reading->stream))) {
      odometry_tallies_[reading->stream].add(reading->time_s, reading->T_odom_robot);
    }
    if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation)) {
      if (lidars_.size() < kMostLidars || lidars_.count(scan->sensorLabel))
        lidars_[scan->sensorLabel].add(*scan);
    } else if (const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(&observation)) {
      has_resolution_ |= comment->text.find("laser_front_laser_resolution") != std::string::npos ||
                         comment->text.find("laser_rear_laser_resolution") != std::string::npos;
      if (const auto note = objects::parseSweepNote(comment->text)) sweeps_[note->label] = note->sweep;
    }
  }
  void takeActions(const CActionCollection& actions) override {
    figures_.has_frames = true;
    odometry_.takeActions(actions);
    streams_.takeActions(actions);
  }
  void takeOther(const mrpt::serialization::CSerializable& object) override { streams_.takeOther(object); }

  void finish(const std::string& lidar, logs::LogFormat format) {
    figures_.streams = streams_.figures();
    for (const auto& [stream, tally] : odometry_tallies_) figures_.odometry.push_back(tally.figures(stream));
    chooseLidar(lidar);
    if (const auto sweep = sweeps_.find(figures_.lidar); sweep != sweeps_.end())
      figures_.stated_sweep = sweep->second;
    // Of all formats, only CARMEN's old laser messages leave out where their readings point to.
    const bool is_old_message = figures_.lidar == "FLASER" || figures_.lidar == "RLASER";
    figures_.is_view_given = format != logs::LogFormat::kCarmen || !is_old_message || has_resolution_;
  }

 private:
  void takeStamp(std::optional<double> time_s) {
    if (!time_s) return;
    if (!newest_s_) figures_.first_s = figures_.last_s = *time_s;
    figures_.first_s = std::min(figures_.first_s, *time_s);
    figures_.last_s = std::max(figures_.last_s, *time_s);
    if (newest_s_ && *time_s < *newest_s_) {
      ++figures_.backward_in_file;
      figures_.largest_backward_in_file_s =
          std::max(figures_.largest_backward_in_file_s, *newest_s_ - *time_s);
    }
    newest_s_ = time_s;
  }
  void chooseLidar(const std::string& wanted) {
    std::uint64_t most = 0;
    std::string labels;
    for (const auto& [label, tally] : lidars_) {
      auto ranges = tally.figures();
      labels += (labels.empty() ? "'" : ", '") + label + "'";
      if (wanted.empty() ? ranges.scans <= most : label != wanted) continue;
      most = ranges.scans;
      figures_.lidar = label;
      figures_.ranges = std::move(ranges);
    }
    if (!wanted.empty() && most == 0)
      throw core::InputError(figures_.path + ": no laser scan with the sensor label '" + wanted +
                             "', found " + (labels.empty() ? "no laser scan at all" : labels));
  }

  LogFigures& figures_;
  StreamSurvey streams_;
  std::map<std::string, calibration::RangeTally> lidars_;
  std::map<std::string, lidar::Sweep> sweeps_;
  OdometryReader odometry_;
  std::map<std::string, calibration::OdometryTally> odometry_tallies_;
  std::optional<double> newest_s_;
  bool has_resolution_ = false;
};

/// The second reading: motion.
class Matching : public LogVisitor {
 public:
  Matching(LogFigures& figures, double period_s)
      : figures_(figures),
        series_(figures.ranges.scans, period_s / kReadingsPerScan),
        pairs_(figures.ranges.scans),
        sweep_pairs_(figures.ranges.scans) {}

  void takeObservation(const CObservation& observation, bool is_in_frame) override {
    if (const auto reading = odometry_.take(observation, is_in_frame)) {
      if (reading->time_s) {
        newest_s_ = reading->time_s;
        // Of several sources the first is as good as any here.
        if (sweep_stream_.empty()) sweep_stream_ = reading->stream;
        if (reading->stream == sweep_stream_) T_odom_robot_ = reading->T_odom_robot;
        if (isKnown(reading->stream))
          series_.addOdometry(reading->stream, {*reading->time_s, reading->T_odom_robot});
      }
    }
    const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation);
    if (scan && scan->sensorLabel == figures_.lidar) takeScan(*scan);
  }
  void takeActions(const CActionCollection& actions) override { odometry_.takeActions(actions); }

  void finish() {
    series_.finish();
    figures_.view = pairs_.fit();
    figures_.sweep = sweep_pairs_.fit();
    double best = -1;
    for (std::size_t i = 0; i < figures_.odometry.size(); ++i) {
      auto& odometry = figures_.odometry[i];
      odometry.clock = calibration::findClockOffset(series_.stretches(), odometry.stream);
      const double merit = odometry.clock.is_observable ? 1 + odometry.clock.correlation : 0;
      const bool is_better =
          merit > best ||
          (merit == best && figures_.best_odometry >= 0 &&
           odometry.readings > figures_.odometry[static_cast<std::size_t>(figures_.best_odometry)].readings);
      if (is_better) best = merit, figures_.best_odometry = static_cast<int>(i);
    }
    if (figures_.best_odometry < 0) return;
    const auto& odometry = figures_.odometry[static_cast<std::size_t>(figures_.best_odometry)];
    const double offset_s = odometry.clock.is_observable ? odometry.clock.offset_s.value : 0;
    figures_.fit = calibration::fitOdometry(series_.stretches(), odometry.stream, offset_s);
    for (const auto& stretch : series_.stretches()) findDisagreements(stretch, odometry.stream, offset_s);
  }

 private:
  bool isKnown(const std::string& stream) const {
    return std::any_of(
        figures_.odometry.begin(), figures_.odometry.end(),
        [&stream](const calibration::OdometryFigures& odometry) { return odometry.stream == stream; });
  }

  void takeScan(const CObservation2DRangeScan& observation) {
    std::optional<double> time_s = stampOf(observation.timestamp);
    if (!time_s) time_s = newest_s_;
    if (!time_s) {
      ++figures_.scans_without_time;
      return;
    }
    lidar::Scan scan;
    try {
      scan = lidar::fromMrpt(observation);
    } catch (const core::InputError& error) {
      if (figures_.refused_scans++ == 0) figures_.refused_scan = error.what();
      return;
    }
    scan.time_s = *time_s;
    newest_s_ = time_s;
    if (const auto& spike = figures_.ranges.spike)
      for (float& range_m : scan.ranges_m)
        if (range_m >= spike->threshold_m) range_m = lidar::kNoReturn;
    const calibration::ScanStep* step = series_.addScan(scan);
    pairs_.addScan(scan, step);
    sweep_pairs_.addScan(scan, motionTo(step));
    T_odom_previous_ = T_odom_robot_;
    if (!step) return;
    ++figures_.matched_pairs;
    if (!step->is_matched) {
      --figures_.matched_pairs;
      if (figures_.unmatched_pairs++ == 0) figures_.first_unmatched_s = step->from_s;
    } else if (!step->is_reliable) {
      ++figures_.unsure_pairs;
    }
  }

  /// The robot's motion since the scan before: the odometry's, else what the scans show, as far as skewed
  /// ones can.
  std::optional<core::Pose2> motionTo(const calibration::ScanStep* step) const {
    if (!step || !step->is_matched) return std::nullopt;
    if (T_odom_previous_ && T_odom_robot_) return core::between(*T_odom_previous_, *T_odom_robot_);
    const auto& mount = figures_.ranges.T_robot_lidar;
    return mount * step->T_previous_lidar * core::inverse(mount);
  }

  void findDisagreements(const calibration::Stretch& stretch, const std::string& stream, double offset_s) {
    constexpr double kLeast_m = 0.5, kLeast_rad = 0.5;
    const calibration::OdometryCurve odometry(stretch, stream);
    const auto& mount = figures_.ranges.T_robot_lidar;
    for (const auto& step : stretch.steps) {
      if (!step.is_reliable || step.to_s <= step.from_s) continue;
      const auto from = odometry.at(step.from_s - offset_s), to = odometry.at(step.to_s - offset_s);
      if (!from || !to) continue;
      const auto T_scans = mount * step.T_previous_lidar * core::inverse(mount);
      const auto error = core::between(T_scans, core::between(*from, *to));
      const double error_m = core::hypot(error.x, error.y), error_rad = std::abs(core::wrapToPi(error.phi));
      if (error_m < kLeast_m && error_rad < kLeast_rad) continue;
      ++figures_.disagreements;
      if (error_m <= figures_.largest_disagreement_m) continue;
      figures_.largest_disagreement_m = error_m;
      figures_.largest_disagreement_rad = error_rad;
      figures_.largest_disagreement_at_s = step.to_s;
    }
  }

  LogFigures& figures_;
  calibration::MotionSeries series_;
  calibration::ViewPairs pairs_;
  calibration::SweepPairs sweep_pairs_;
  std::string sweep_stream_;
  std::optional<core::Pose2> T_odom_robot_, T_odom_previous_;  ///< at this scan and at the one before
  OdometryReader odometry_;
  std::optional<double> newest_s_;
};

/// Visits all objects up to the end or the damage; the reader's words for it, or "".
std::string visitAll(objects::ObjectSource& source, LogVisitor& visitor, core::Progress& progress,
                     const LogFigures& figures) {
  constexpr std::uint64_t kBetweenReports = 256;
  try {
    while (const auto object = source.next()) {
      visitor.visit(*object);
      if (source.count() % kBetweenReports == 0)
        progress.update(source.fractionRead(), source.fractionRead() * (figures.last_s - figures.first_s));
    }
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

/// Ranges in another unit than metres: nothing can be matched.
bool isInMetres(const calibration::RangeFigures& ranges) {
  return ranges.median_m < 60;
}

}  // namespace

bool LogCheck::isUsable() const {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.severity == Severity::kError; });
}

int LogCheck::warnings() const {
  return static_cast<int>(std::count_if(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.severity == Severity::kWarning;
  }));
}

LogCheck checkLog(const std::string& path, const std::string& lidar, core::Progress& progress) {
  LogCheck check;
  auto& figures = check.figures;
  figures.path = path;
  const auto format = logs::detectLogFormat(path);
  figures.format = logs::formatName(format);
  figures.file_bytes = std::filesystem::file_size(path);
  {
    progress.begin("reading " + path);
    const auto source = logs::openLog(path);
    Survey survey(figures);
    figures.damage = visitAll(*source, survey, progress, figures);
    figures.objects = source->count();
    figures.skipped = source->skipped();
    survey.finish(lidar, format);
    progress.end();
  }
  if (figures.ranges.scans > 0 && isInMetres(figures.ranges)) {
    progress.begin("matching the scans of " + path);
    const auto source = logs::openLog(path);
    double period_s = 0;
    for (const auto& stream : figures.streams)
      if (stream.kind == "CObservation2DRangeScan" && stream.label == figures.lidar)
        period_s = stream.median_period_s;
    Matching matching(figures, period_s);
    const std::string broken = visitAll(*source, matching, progress, figures);
    if (figures.damage.empty()) figures.damage = broken;  // of the machine, at the second reading
    matching.finish();
    progress.end();
  }
  check.findings = findingsOf(figures);
  return check;
}

std::vector<calibration::StreamFigures> streamsOf(const std::string& path) {
  struct Streams : LogVisitor {
    StreamSurvey survey;
    void takeObservation(const CObservation& observation, bool) override {
      survey.takeObservation(observation);
    }
    void takeActions(const CActionCollection& actions) override { survey.takeActions(actions); }
    void takeOther(const mrpt::serialization::CSerializable& object) override { survey.takeOther(object); }
  } streams;
  const auto source = logs::openLog(path);
  const std::string broken = visitAll(*source, streams, core::silentProgress(), {});
  if (!broken.empty()) throw core::InputError(broken);
  return streams.survey.figures();
}

}  // namespace slam::doctor
