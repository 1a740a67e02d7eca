#include "libslam/edit/convert.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/log_reader.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/rawlogs/log_motion.h"

namespace slam::edit {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationRobotPose;
using mrpt::obs::CSensoryFrame;
using Object = std::shared_ptr<mrpt::serialization::CSerializable>;

/// Takes true poses out of the stream, and scans of other lidars.
class Sieve : public objects::ObjectSource {
 public:
  Sieve(std::unique_ptr<objects::ObjectSource> source, std::string label)
      : source_(std::move(source)), label_(std::move(label)) {}

  Object next() override {
    while (auto object = source_->next()) {
      if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
        for (auto it = frame->begin(); it != frame->end();) it = passes(**it) ? it + 1 : frame->erase(it);
        return object;
      }
      const auto* observation = dynamic_cast<const CObservation*>(object.get());
      if (!observation || passes(*observation)) return object;
    }
    return nullptr;
  }
  std::uint64_t count() const override { return source_->count(); }
  double fractionRead() const override { return source_->fractionRead(); }
  std::string place() const override { return source_->place(); }
  std::string skipped() const override { return source_->skipped(); }

  core::Trajectory truth;
  std::map<std::string, std::uint64_t> left_out;

 private:
  bool passes(const CObservation& observation) {
    if (const auto* pose = dynamic_cast<const CObservationRobotPose*>(&observation)) {
      if (pose->sensorLabel != objects::kTruthLabel) return true;
      truth.push_back(
          {objects::secondsFromMrptTicks(objects::ticksOf(*pose)), objects::fromMrpt(pose->pose.mean)});
      return false;
    }
    if (label_.empty() || observation.sensorLabel == label_ ||
        !dynamic_cast<const CObservation2DRangeScan*>(&observation))
      return true;
    ++left_out[observation.sensorLabel];
    return false;
  }

  std::unique_ptr<objects::ObjectSource> source_;
  std::string label_;
};

void sortByTime(core::Trajectory& trajectory) {
  std::stable_sort(trajectory.begin(), trajectory.end(),
                   [](const auto& a, const auto& b) { return a.time_s < b.time_s; });
}

class Counter {
 public:
  explicit Counter(ConversionReport& report) : report_(report) {}

  /// The object's stamp in seconds since the first one, for progress.
  double take(const mrpt::serialization::CSerializable& object) {
    if (const auto* actions = dynamic_cast<const CActionCollection*>(&object)) {
      report_.odometry_readings += rawlogs::incrementOf(*actions) ? 1 : 0;
    } else if (const auto* frame = dynamic_cast<const CSensoryFrame*>(&object)) {
      for (const auto& observation : *frame) takeObservation(*observation);
    } else if (const auto* observation = dynamic_cast<const CObservation*>(&object)) {
      takeObservation(*observation);
    }
    return newest_s_ - first_s_;
  }

 private:
  void takeObservation(const CObservation& observation) {
    if (dynamic_cast<const mrpt::obs::CObservationComment*>(&observation)) {
      ++report_.comments;
      return;
    }
    if (objects::ticksOf(observation) != objects::kNoStamp) {
      newest_s_ = objects::secondsFromMrptTicks(objects::ticksOf(observation));
      if (std::exchange(is_first_, false)) first_s_ = newest_s_;
    }
    if (dynamic_cast<const CObservation2DRangeScan*>(&observation))
      ++report_.scans_by_label[observation.sensorLabel];
    else if (dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation))
      ++report_.odometry_readings;
    else
      ++report_.other_observations;
  }

  ConversionReport& report_;
  bool is_first_ = true;
  double first_s_ = 0, newest_s_ = 0;
};

void requireLabel(const std::string& in, const std::string& label,
                  const std::map<std::string, std::uint64_t>& written,
                  const std::map<std::string, std::uint64_t>& left_out) {
  if (label.empty() || written.count(label) > 0) return;
  std::string found;
  for (const auto& [name, scans] : left_out)
    found += (found.empty() ? "'" : ", '") + name + "' (" + std::to_string(scans) + " scans)";
  throw core::InputError(in + ": no laser scan with the sensor label '" + label + "', found " +
                         (found.empty() ? "none" : found));
}

}  // namespace

ConversionReport convertLog(const std::string& in, const std::string& out, const LogConversion& conversion,
                            core::Progress& progress) {
  files::refuseToOverwrite(out, conversion.overwrite);
  ConversionReport report;
  report.from = logs::detectLogFormat(in);
  auto sieve = std::make_unique<Sieve>(logs::openLog(in), conversion.label);
  auto& sieved = *sieve;
  std::unique_ptr<objects::ObjectSource> source = std::move(sieve);
  const bool is_rawlog = conversion.to == logs::LogFormat::kRawlog;
  if (!is_rawlog || conversion.form)
    source = rawlogs::inForm(std::move(source),
                             is_rawlog ? *conversion.form : rawlogs::RawlogForm::kObservationOnly, in);
  const auto sink = logs::createLog(out, conversion.to);
  Counter counter(report);
  progress.begin("converting to " + std::string(logs::formatName(conversion.to)));
  while (const auto object = source->next()) {
    const double log_time_s = counter.take(*object);
    sink->write(*object);
    progress.update(source->fractionRead(), log_time_s);
  }
  progress.end();
  requireLabel(in, conversion.label, report.scans_by_label, sieved.left_out);
  if (source->count() == 0 && sieved.truth.empty())
    throw core::InputError(in + ": holds nothing, expected at least 1 observation");
  for (const auto& [label, scans] : sieved.left_out) report.scans_left_out += scans;
  report.true_poses = sieved.truth.size();
  report.skipped = source->skipped();
  report.dropped = sink->dropped();
  report.files = {out};
  if (!sieved.truth.empty()) {
    sortByTime(sieved.truth);
    const std::string tum = logs::logStem(out) + ".truth.tum", mrpt = out + ".GT.txt";
    for (const auto& path : {tum, mrpt}) files::refuseToOverwrite(path, conversion.overwrite);
    logs::writeTum(sieved.truth, tum);
    logs::writeMrptGroundTruth(sieved.truth, mrpt);
    report.files.insert(report.files.end(), {tum, mrpt});
  }
  sink->close();
  return report;
}

std::size_t exportTrajectory(const std::string& in, LogPath path, const std::string& label,
                             const std::string& out, logs::TrajectoryWriter::Format format, bool overwrite,
                             core::Progress& progress) {
  files::refuseToOverwrite(out, overwrite);
  core::Trajectory trajectory;
  const auto since_start = [&trajectory] { return trajectory.back().time_s - trajectory.front().time_s; };
  progress.begin("reading the " + std::string(path == LogPath::kTruth ? "truth" : "odometry"));
  if (path == LogPath::kTruth) {
    Sieve sieve(logs::openLog(in), "");
    while (sieve.next()) progress.update(sieve.fractionRead(), 0);
    trajectory = std::move(sieve.truth);
    if (trajectory.empty()) throw core::InputError(in + ": holds no true pose, expected at least 1");
  } else {
    logs::LogReader reader(in, label);
    bool has_odometry = false;
    while (const auto entry = reader.next()) {
      has_odometry |= entry->has_odometry;
      trajectory.push_back({entry->scan.time_s, entry->T_odom_robot});
      progress.update(reader.fractionRead(), since_start());
    }
    if (trajectory.empty()) throw core::InputError(in + ": holds 0 laser scans, expected at least 1");
    if (!has_odometry) throw core::InputError(in + ": holds no odometry, expected some");
  }
  progress.end();
  sortByTime(trajectory);
  writeTrajectory(trajectory, out, format);
  return trajectory.size();
}

}  // namespace slam::edit
