#include "libslam/edit/log_edit.h"

#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/edit/log_steps.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"

namespace slam::edit {
namespace {

using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CSensoryFrame;

/// Progress over one or two logs.
class Reports {
 public:
  Reports(core::Progress& progress, const std::string& stage) : progress_(progress) {
    progress_.begin(stage);
  }
  void step(double fraction, std::int64_t ticks) {
    if (ticks != objects::kNoStamp && first_ticks_ == objects::kNoStamp) first_ticks_ = ticks;
    if (ticks != objects::kNoStamp) last_ticks_ = ticks;
    constexpr std::uint64_t kBetweenReports = 64;
    if (++steps_ % kBetweenReports == 0)
      progress_.update(
          fraction, objects::secondsFromMrptTicks(last_ticks_) - objects::secondsFromMrptTicks(first_ticks_));
  }
  void end() { progress_.end(); }

 private:
  core::Progress& progress_;
  std::uint64_t steps_ = 0;
  std::int64_t first_ticks_ = objects::kNoStamp, last_ticks_ = objects::kNoStamp;
};

/// What a filter makes of one observation after the other.
class ObservationFilter {
 public:
  ObservationFilter(const FilterOptions& options, const std::string& path) : options_(options), path_(path) {}

  /// The same pointer where nothing is to be done, nullptr where it is to be dropped.
  CObservation::Ptr pass(const CObservation::Ptr& observation) {
    const std::string& label = observation->sensorLabel;
    seen_.insert(label);
    const auto names = [&label](const std::vector<std::string>& labels) {
      return std::find(labels.begin(), labels.end(), label) != labels.end();
    };
    if (!options_.keep_labels.empty() && !names(options_.keep_labels)) return nullptr;
    if (names(options_.drop_labels) || (options_.drop_truth && label == objects::kTruthLabel)) return nullptr;
    const bool mends_scans = options_.no_return_m || options_.step_rad || options_.mount;
    const bool is_scan = dynamic_cast<const CObservation2DRangeScan*>(observation.get()) != nullptr;
    const auto shift = options_.shift_s.find(label);
    if (!(mends_scans && is_scan) && shift == options_.shift_s.end()) return observation;
    auto changed = std::dynamic_pointer_cast<CObservation>(observation->duplicateGetSmartPtr());
    if (shift != options_.shift_s.end()) move(*changed, shift->second);
    if (auto* scan = dynamic_cast<CObservation2DRangeScan*>(changed.get())) mend(*scan);
    return changed;
  }

  void requireLabelsSeen() const {
    auto named = options_.keep_labels;
    named.insert(named.end(), options_.drop_labels.begin(), options_.drop_labels.end());
    for (const auto& shift : options_.shift_s) named.push_back(shift.first);
    std::string labels;
    for (const auto& label : seen_) labels += (labels.empty() ? "'" : ", '") + label + "'";
    for (const auto& label : named)
      if (!seen_.count(label))
        throw core::InputError(path_ + ": no observation with the sensor label '" + label + "', found " +
                               labels);
  }

 private:
  static void move(CObservation& observation, double shift_s) {
    const auto ticks = observation.timestamp.time_since_epoch().count();
    if (ticks == objects::kNoStamp) return;
    // Around zero, where a double tells every tick; the sum stays whole.
    const auto moved = mrpt::Clock::duration(ticks + std::llround(shift_s * kTicksPerSecond));
    objects::mrptTicks(objects::secondsFromMrptTicks(moved.count()));
    observation.timestamp = mrpt::Clock::time_point(moved);
  }

  void mend(CObservation2DRangeScan& scan) const {
    const size_t readings = scan.getScanSize();
    if (options_.step_rad) {
      const double aperture_rad = *options_.step_rad * static_cast<double>(std::max<size_t>(readings, 1) - 1);
      if (aperture_rad > 2 * core::kPi + 1e-6)
        throw core::InputError(path_ + ": " + std::to_string(readings) + " readings " +
                               files::formatNumber(core::radToDeg(*options_.step_rad)) +
                               " deg apart go round more than once, expected at most 360 deg");
      scan.aperture = static_cast<float>(aperture_rad);
    }
    if (options_.mount) {
      const auto& old = scan.sensorPose;
      scan.sensorPose = mrpt::poses::CPose3D(options_.mount->x, options_.mount->y, old.z(),
                                             options_.mount->phi, old.pitch(), old.roll());
    }
    if (!options_.no_return_m) return;
    const auto limit_m = static_cast<float>(*options_.no_return_m);
    scan.maxRange = limit_m;
    for (size_t i = 0; i < readings; ++i)
      if (scan.getScanRange(i) >= limit_m) scan.setScanRangeValidity(i, false);
  }

  static constexpr double kTicksPerSecond = 1e7;
  const FilterOptions& options_;
  const std::string& path_;
  std::set<std::string> seen_;
};

/// Filters a step in place. False: it is to be dropped.
bool filterStep(LogStep& step, ObservationFilter& filter) {
  if (!step.rest) return true;
  if (const auto observation = std::dynamic_pointer_cast<CObservation>(step.rest->content)) {
    const auto passed = filter.pass(observation);
    if (!passed) return false;
    if (passed != observation) step.rest = LogObject{passed, "", true};
    return true;
  }
  const auto* frame = dynamic_cast<const CSensoryFrame*>(step.rest->content.get());
  if (!frame || frame->empty()) return true;
  auto passed_frame = CSensoryFrame::Create();
  bool is_changed = false;
  for (const auto& observation : *frame) {
    const auto passed = filter.pass(observation);
    is_changed |= passed != observation;
    if (passed) passed_frame->insert(passed);
  }
  if (passed_frame->empty()) return false;
  if (is_changed) step.rest = LogObject{passed_frame, "", true};
  return true;
}

/// The lidar's label where the step is one of its scans, or a frame with scans; these count together.
std::optional<std::string> scansOf(const LogStep& step) {
  if (!step.rest) return std::nullopt;
  if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(step.rest->content.get()))
    return "bare " + scan->sensorLabel;
  if (const auto* frame = dynamic_cast<const CSensoryFrame*>(step.rest->content.get()))
    for (const auto& observation : *frame)
      if (dynamic_cast<const CObservation2DRangeScan*>(observation.get())) return "frames";
  return std::nullopt;
}

}  // namespace

EditCounts cutLog(const std::string& path, const std::string& output, const CutOptions& options,
                  core::Progress& progress) {
  StepReader reader(path);
  StepWriter writer(output);
  Reports reports(progress, "cutting " + path);
  std::optional<double> start_s;
  bool is_kept = true;
  const auto secondsAt = [&start_s](const LogMoment& moment) {
    return moment.is_absolute ? moment.seconds : *start_s + moment.seconds;
  };
  try {
    while (const auto step = reader.next()) {
      reports.step(reader.fractionRead(), step->ticks);
      if (step->ticks != objects::kNoStamp) {
        const double time_s = objects::secondsFromMrptTicks(step->ticks);
        if (!start_s) start_s = time_s;
        is_kept = (!options.from || time_s >= secondsAt(*options.from)) &&
                  (!options.to || time_s < secondsAt(*options.to));
      }
      if (is_kept) writer.write(*step);
    }
  } catch (const core::InputError& error) {
    if (!options.salvage) throw;
    writer.counts().damage = error.what();
  }
  writer.close(reader.count());
  reports.end();
  return writer.counts();
}

EditCounts mergeLogs(const std::string& first, const std::string& second, const std::string& output,
                     core::Progress& progress) {
  StepReader readers[2] = {StepReader(first), StepReader(second)};
  StepWriter writer(output);
  Reports reports(progress, "merging " + first);
  std::optional<LogStep> heads[2];
  std::int64_t ticks[2] = {objects::kNoStamp,
                           objects::kNoStamp};  // of the newest step with a stamp; the epoch sorts before all
  const auto advance = [&](size_t side) {
    heads[side] = readers[side].next();
    if (heads[side] && heads[side]->ticks != objects::kNoStamp) ticks[side] = heads[side]->ticks;
  };
  advance(0);
  advance(1);
  std::optional<size_t> mover;  // whose action came last
  bool is_over[2] = {};         // the other log's action came after one of this log's
  while (heads[0] || heads[1]) {
    const size_t side = !heads[0] || (heads[1] && ticks[1] < ticks[0]) ? 1 : 0;
    const LogStep& step = *heads[side];
    reports.step((readers[0].fractionRead() + readers[1].fractionRead()) / 2, step.ticks);
    if (!step.actions.empty()) {
      if (is_over[side])
        throw core::InputError(second + ": holds actions at the same time as " + first +
                               ", expected one of the two without, or one after the other");
      if (mover && *mover != side) is_over[*mover] = true;
      mover = side;
    }
    writer.write(step);
    advance(side);
  }
  writer.close(readers[0].count() + readers[1].count());
  reports.end();
  return writer.counts();
}

EditCounts filterLog(const std::string& path, const std::string& output, const FilterOptions& options,
                     core::Progress& progress) {
  if (options.every == 0) throw core::ContractError("filterLog: every 0th scan");
  StepReader reader(path);
  StepWriter writer(output);
  Reports reports(progress, "filtering " + path);
  ObservationFilter filter(options, path);
  std::map<std::string, std::uint64_t> scans;
  while (auto step = reader.next()) {
    reports.step(reader.fractionRead(), step->ticks);
    bool is_kept = filterStep(*step, filter);
    if (is_kept)
      if (const auto lidar = scansOf(*step)) is_kept = scans[*lidar]++ % options.every == 0;
    is_kept ? writer.write(*step) : writer.drop(*step);
  }
  filter.requireLabelsSeen();
  writer.close(reader.count());
  reports.end();
  return writer.counts();
}

}  // namespace slam::edit
