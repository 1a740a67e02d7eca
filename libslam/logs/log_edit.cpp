#include "libslam/logs/log_edit.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <set>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/rawlog_stream.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"

namespace slam::logs {
namespace {

using mrpt::obs::CAction;
using mrpt::obs::CActionCollection;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::obs::CActionRobotMovement3D;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CSensoryFrame;
using mrpt::serialization::CSerializable;

struct Object {
  std::shared_ptr<CSerializable> content;
  std::string bytes;  ///< as in the file; "" where it has none of MRPT's, or other content now
  bool is_changed = false;
};

/// What is kept or dropped together: a frame with the actions that lead to it, or anything else alone.
struct Step {
  std::vector<Object> actions;
  std::optional<Object> rest;  ///< none: actions at the end of the log
  std::int64_t ticks = objects::kNoStamp;

  std::uint64_t objects() const { return actions.size() + (rest ? 1 : 0); }
  bool isFrame() const { return rest && dynamic_cast<const CSensoryFrame*>(rest->content.get()); }
};

// Actions that wait for their frame. More than this is a log without frames.
constexpr size_t kMostWaiting = 1000;

std::int64_t ticksOf(const CSerializable& object) {
  const auto ticks = [](const auto& stamped) -> std::int64_t {
    return stamped.timestamp.time_since_epoch().count();
  };
  if (const auto* observation = dynamic_cast<const CObservation*>(&object)) return ticks(*observation);
  if (const auto* frame = dynamic_cast<const CSensoryFrame*>(&object)) {
    for (const auto& observation : *frame)
      if (ticks(*observation) != objects::kNoStamp) return ticks(*observation);
  } else if (const auto* actions = dynamic_cast<const CActionCollection*>(&object)) {
    for (const auto& action : *actions)
      if (ticks(*action) != objects::kNoStamp) return ticks(*action);
  }
  return objects::kNoStamp;
}

class StepReader {
 public:
  explicit StepReader(const std::string& path) {
    if (detectLogFormat(path) == LogFormat::kRawlog) {
      auto rawlog = std::make_unique<RawlogObjects>(path);
      rawlog_ = rawlog.get();
      source_ = std::move(rawlog);
    } else {
      source_ = openLog(path);
    }
  }

  std::optional<Step> next() {
    Step step;
    while (const auto content = source_->next()) {
      Object object{content, rawlog_ ? rawlog_->bytes() : ""};
      const bool is_actions = dynamic_cast<const CActionCollection*>(content.get()) != nullptr;
      const bool is_frame = dynamic_cast<const CSensoryFrame*>(content.get()) != nullptr;
      if (is_actions) {
        waiting_.push_back(std::move(object));
        if (waiting_.size() < kMostWaiting) continue;
        break;
      }
      if (is_frame) step.actions = std::exchange(waiting_, {});
      step.rest = std::move(object);
      setTime(step);
      return step;
    }
    if (waiting_.empty()) return std::nullopt;
    step.actions = std::exchange(waiting_, {});
    setTime(step);
    return step;
  }
  double fractionRead() const { return source_->fractionRead(); }
  std::uint64_t count() const { return source_->count(); }

 private:
  static void setTime(Step& step) {
    if (step.rest) step.ticks = ticksOf(*step.rest->content);
    for (const auto& action : step.actions)
      if (step.ticks == objects::kNoStamp) step.ticks = ticksOf(*action.content);
  }

  std::unique_ptr<objects::ObjectSource> source_;
  const RawlogObjects* rawlog_ = nullptr;
  std::vector<Object> waiting_;  ///< actions before their frame
};

/// The robot's way through several steps in one action per way of measuring it.
class ComposedActions {
 public:
  void add(const CActionCollection& actions) {
    others_.clear();
    for (const auto& action : actions) {
      if (const auto* planar = dynamic_cast<const CActionRobotMovement2D*>(action.get()))
        planar->estimationMethod == CActionRobotMovement2D::emOdometry ? addWheels(*planar)
                                                                       : addMatched(*planar);
      else if (const auto* spatial = dynamic_cast<const CActionRobotMovement3D*>(action.get()))
        addSpatial(*spatial);
      else
        others_.push_back(std::dynamic_pointer_cast<CAction>(action->duplicateGetSmartPtr()));
    }
  }
  std::shared_ptr<CActionCollection> collection() const {
    auto result = CActionCollection::Create();
    if (wheels_) result->insert(*wheels_);
    if (matched_) result->insert(*matched_);
    if (spatial_) result->insert(*spatial_);
    for (const auto& action : others_) result->insert(*action);
    return result;
  }

 private:
  void addWheels(const CActionRobotMovement2D& next) {
    if (!wheels_) {
      wheels_ = next;
      return;
    }
    const auto sum = wheels_->rawOdometryIncrementReading + next.rawOdometryIncrementReading;
    const bool have_ticks = wheels_->hasEncodersInfo && next.hasEncodersInfo;
    const auto left = wheels_->encoderLeftTicks + next.encoderLeftTicks;
    const auto right = wheels_->encoderRightTicks + next.encoderRightTicks;
    wheels_ = next;
    wheels_->computeFromOdometry(sum, next.motionModelConfiguration);
    wheels_->hasEncodersInfo = have_ticks;
    wheels_->encoderLeftTicks = left;
    wheels_->encoderRightTicks = right;
  }
  void addMatched(const CActionRobotMovement2D& next) {
    if (!matched_ || !next.poseChange || !matched_->poseChange) {
      if (!matched_ || next.poseChange) matched_ = next;
      return;
    }
    mrpt::poses::CPosePDFGaussian sum, step;
    sum.copyFrom(*matched_->poseChange);
    step.copyFrom(*next.poseChange);
    sum += step;
    matched_ = next;
    matched_->poseChange = mrpt::poses::CPosePDFGaussian::Create(sum);
  }
  void addSpatial(const CActionRobotMovement3D& next) {
    if (!spatial_) {
      spatial_ = next;
      return;
    }
    auto sum = spatial_->poseChange;
    sum += next.poseChange;
    const auto raw = spatial_->rawOdometryIncrementReading + next.rawOdometryIncrementReading;
    spatial_ = next;
    spatial_->poseChange = sum;
    spatial_->rawOdometryIncrementReading = raw;
  }

  std::optional<CActionRobotMovement2D> wheels_, matched_;
  std::optional<CActionRobotMovement3D> spatial_;
  std::vector<CAction::Ptr> others_;  ///< of the newest step
};

/// Writes steps, and takes up the actions of those that are dropped in between.
class StepWriter {
 public:
  explicit StepWriter(const std::string& path)
      : path_(path), pending_(path), stream_(pending_.path(), path) {}

  void write(const Step& step) {
    if (step.isFrame() && dropped_) {
      for (const auto& actions : step.actions) take(actions);
      write({dropped_->collection(), "", true});
      dropped_.reset();
      ++counts_.composed;
    } else {
      for (const auto& actions : step.actions) write(actions);
    }
    if (step.rest) write(*step.rest);
  }
  /// A step in the middle that is left out.
  void drop(const Step& step) {
    for (const auto& actions : step.actions) take(actions);
  }

  void close(std::uint64_t read) {
    const std::uint64_t written = counts_.unchanged + counts_.changed;
    if (written == 0)
      throw core::InputError(path_ + ": nothing would be left of " + std::to_string(read) +
                             " objects, expected at least one");
    counts_.read = read;
    counts_.dropped = read - written;
    stream_.close();
    pending_.commit();
  }
  EditCounts& counts() { return counts_; }

 private:
  void take(const Object& actions) {
    if (!dropped_) dropped_.emplace();
    dropped_->add(dynamic_cast<const CActionCollection&>(*actions.content));
  }
  void write(const Object& object) {
    if (object.bytes.empty())
      serialize(*object.content);
    else
      stream_.Write(object.bytes.data(), object.bytes.size());
    ++(object.is_changed ? counts_.changed : counts_.unchanged);
  }
  void serialize(const CSerializable& object) {
    try {
      mrpt::serialization::archiveFrom<mrpt::io::CStream>(stream_) << object;
    } catch (const std::exception&) {
      stream_.rethrowFailure();
      throw;
    }
  }

  std::optional<ComposedActions> dropped_;
  std::string path_;
  core::PendingFile pending_;
  PackingStream stream_;
  EditCounts counts_;
};

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
                               core::formatNumber(core::radToDeg(*options_.step_rad)) +
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
bool filterStep(Step& step, ObservationFilter& filter) {
  if (!step.rest) return true;
  if (const auto observation = std::dynamic_pointer_cast<CObservation>(step.rest->content)) {
    const auto passed = filter.pass(observation);
    if (!passed) return false;
    if (passed != observation) step.rest = Object{passed, "", true};
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
  if (is_changed) step.rest = Object{passed_frame, "", true};
  return true;
}

/// The lidar's label where the step is one of its scans, or a frame with scans; these count together.
std::optional<std::string> scansOf(const Step& step) {
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
  std::optional<Step> heads[2];
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
    const Step& step = *heads[side];
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

}  // namespace slam::logs
