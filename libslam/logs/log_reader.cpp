#include "libslam/logs/log_reader.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <exception>
#include <utility>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/lidar/mrpt_types.h"
#include "libslam/logs/lidar_choice.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/unmarked_no_return.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/objects/object_stream.h"
#include "libslam/objects/sweep_note.h"
#include "libslam/rawlogs/log_motion.h"

namespace slam::logs {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CSensoryFrame;

constexpr size_t kScansToChooseLabel = 100;
constexpr double kSameMoment_s = 1e-3;
/// A scan of whichever lidar with the motion since the scan before it, of whichever lidar.
struct Step {
  LidarScan seen;
  rawlogs::Motion motion;
  std::uint64_t frame = 0;  ///< which frame it came in; 0: none
  double tilt_rad = 0;
};

/// From the objects of a rawlog, whatever its form, to scans with increments.
class StepReader {
 public:
  explicit StepReader(const std::string& path) : path_(path), objects_(openLog(path)) {}

  std::optional<Step> next() {
    while (ready_.empty()) {
      const auto object = objects_->next();
      if (!object) return std::nullopt;
      counts_.entries = objects_->count();
      take(*object);
    }
    Step step = std::move(ready_.front());
    ready_.pop_front();
    return step;
  }
  const LogCounts& counts() const { return counts_; }
  double fractionRead() const { return objects_->fractionRead(); }

 private:
  void take(const mrpt::serialization::CSerializable& object) {
    if (const auto* actions = dynamic_cast<const CActionCollection*>(&object)) {
      counts_.has_frames = true;
      takeActions(*actions);
    } else if (const auto* frame = dynamic_cast<const CSensoryFrame*>(&object)) {
      counts_.has_frames = true;
      takeFrame(*frame);
    } else if (const auto* observation = dynamic_cast<const CObservation*>(&object)) {
      counts_.has_bare_observations = true;
      takeObservation(*observation);
    } else {
      ++counts_.other_observations;
    }
  }

  void takeActions(const CActionCollection& actions) {
    for (const auto& action : actions) noteStamp(action->timestamp);
    const auto increment = rawlogs::incrementOf(actions);
    if (!increment) return;
    requireFinite(*increment);
    ++counts_.odometry_readings;
    has_actions_ = true;
    motion_.add(*increment);
  }

  void takeFrame(const CSensoryFrame& frame) {
    // A frame is one moment: its odometry, and what it says of sweeps, belong to its scans wherever they
    // stand among them.
    const auto isScan = [](const CObservation& observation) {
      return dynamic_cast<const CObservation2DRangeScan*>(&observation) != nullptr;
    };
    frame_ = ++frames_;
    for (const auto& observation : frame)
      if (!isScan(*observation)) takeObservation(*observation);
    for (const auto& observation : frame)
      if (isScan(*observation)) takeObservation(*observation);
    frame_ = 0;
  }

  void takeObservation(const CObservation& observation) {
    if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation))
      takeScan(*scan);
    else if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation))
      takeReading(*odometry);
    else if (const auto* comment = dynamic_cast<const mrpt::obs::CObservationComment*>(&observation))
      takeComment(*comment);
    else
      ++counts_.other_observations;
  }

  void takeComment(const mrpt::obs::CObservationComment& comment) {
    ++counts_.other_observations;
    try {
      if (const auto note = objects::parseSweepNote(comment.text)) sweeps_[note->label] = note->sweep;
    } catch (const core::InputError& error) {
      fail(error.what());
    }
  }

  void takeReading(const CObservationOdometry& odometry) {
    noteStamp(odometry.timestamp);
    const auto pose = objects::fromMrpt(odometry.odometry);
    requireFinite(pose);
    ++counts_.odometry_readings;
    if (has_actions_) return;
    bare_odometry_.add(objects::ticksOf(odometry), pose);
  }

  void takeScan(const CObservation2DRangeScan& observation) {
    ++counts_.scans_by_label[observation.sensorLabel];
    std::int64_t ticks = objects::ticksOf(observation);
    if (ticks == objects::kNoStamp) ticks = newest_ticks_;
    if (ticks == objects::kNoStamp)
      fail("laser scan without a time stamp, and no action or odometry before it has one");
    if (!has_actions_) motion_.add(bare_odometry_.takeUntil(ticks));
    Step step;
    step.seen.lidar = observation.sensorLabel;
    try {
      step.seen.scan = lidar::fromMrpt(observation);
    } catch (const core::InputError& error) {
      fail(error.what());
    }
    step.seen.scan.time_s = objects::secondsFromMrptTicks(ticks);
    if (const auto sweep = sweeps_.find(observation.sensorLabel); sweep != sweeps_.end())
      step.seen.sweep = sweep->second;
    step.frame = frame_;
    step.tilt_rad = core::acos(std::clamp(observation.sensorPose.getRotationMatrix()(2, 2), -1.0, 1.0));
    step.motion = std::exchange(motion_, rawlogs::Motion{});
    ready_.push_back(std::move(step));
  }

  void noteStamp(const mrpt::Clock::time_point& stamp) {
    if (stamp.time_since_epoch().count() != objects::kNoStamp)
      newest_ticks_ = stamp.time_since_epoch().count();
  }

  void requireFinite(const core::Pose2& odometry) const {
    if (!core::isFinite(odometry)) fail("odometry that is not finite");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw core::InputError(path_ + ": " + objects_->place() + ": " + what);
  }

  std::string path_;
  std::unique_ptr<objects::ObjectSource> objects_;
  LogCounts counts_;
  rawlogs::Motion motion_;
  bool has_actions_ = false;  ///< an action with an increment was met: bare readings count no more
  rawlogs::BareOdometry bare_odometry_;
  std::map<std::string, lidar::Sweep> sweeps_;     ///< by label, as stated so far
  std::uint64_t frames_ = 0, frame_ = 0;           ///< how many; the one at work
  std::int64_t newest_ticks_ = objects::kNoStamp;  ///< of an action or odometry reading
  std::deque<Step> ready_;
};

}  // namespace

struct LogReader::State {
  State(const std::string& log_path, const std::string& wanted)
      : path(log_path), steps(log_path), lidars_wanted(wanted) {}

  /// Reads ahead, keeping an error for when the scans before it are used up.
  void choose() {
    is_chosen = true;
    while (ahead.size() < kScansToChooseLabel && readAhead()) continue;
    std::vector<SeenScan> seen;
    for (const Step& step : ahead) seen.push_back({&step.seen, step.tilt_rad});
    chosen = namedLidars(lidars_wanted);
    if (chosen.empty()) {
      const auto choice = lidars_wanted == kAllLidars ? allLidars(seen) : mainLidar(seen);
      chosen = choice.labels, remarks = choice.passed_over;
    } else {
      requireAgreement(path, seen, chosen);
    }
    for (const auto& label : chosen)
      if (const auto why = impossibleSweep(seen, label); !why.empty())
        no_sweep.push_back(label), remarks.push_back(why);
    for (const auto& label : chosen)
      if (const auto found = unmarkedNoReturn(seen, label))
        no_return_m[label] = found->reading_m, remarks.push_back(sayUnmarked(*found, label));
  }

  /// One step more; false at the end, or where the log breaks.
  bool readAhead() {
    if (error_ahead) return false;
    try {
      auto step = steps.next();
      if (step) ahead.push_back(std::move(*step));
      return step.has_value();
    } catch (const core::InputError&) {
      error_ahead = std::current_exception();
      return false;
    }
  }

  std::optional<Step> nextStep() {
    if (ahead.empty() && error_ahead) std::rethrow_exception(error_ahead);
    if (ahead.empty()) return steps.next();
    Step step = std::move(ahead.front());
    ahead.pop_front();
    return step;
  }

  bool isChosen(const std::string& label) const {
    return std::find(chosen.begin(), chosen.end(), label) != chosen.end();
  }

  LogEntry toEntry(Step&& step) {
    LogEntry entry;
    const rawlogs::Motion since_last = std::exchange(motion, rawlogs::Motion{});
    if (is_first) {
      entry.has_odometry = since_last.has_reading;
    } else {
      entry.has_odometry = since_last.has_increment;
      entry.T_previous_robot = since_last.T_previous_robot;
    }
    is_first = false;
    T_odom_robot = T_odom_robot * entry.T_previous_robot;
    entry.T_odom_robot = T_odom_robot;
    if (chosen.size() > 1) gather(step, entry.others);
    entry.lidar = std::move(step.seen.lidar);
    entry.scan = std::move(step.seen.scan);
    entry.sweep = step.seen.sweep;
    mend(entry.lidar, entry.scan, entry.sweep);
    for (auto& other : entry.others) mend(other.lidar, other.scan, other.sweep);
    return entry;
  }

  /// What remarks() say of a lidar.
  void mend(const std::string& label, lidar::Scan& scan, std::optional<lidar::Sweep>& sweep) const {
    dropImpossible(label, sweep);
    if (const auto found = no_return_m.find(label); found != no_return_m.end())
      markNoReturns(scan, found->second);
  }

  void dropImpossible(const std::string& label, std::optional<lidar::Sweep>& sweep) const {
    if (std::find(no_sweep.begin(), no_sweep.end(), label) != no_sweep.end()) sweep.reset();
  }

  /// What other lidars saw at the same moment. The main one's becomes `step`.
  void gather(Step& step, std::vector<LidarScan>& others) {
    const auto isNew = [&](const std::string& label) {
      return label != step.seen.lidar && std::none_of(others.begin(), others.end(), [&](const auto& other) {
               return other.lidar == label;
             });
    };
    while (!ahead.empty() || readAhead()) {
      Step& next = ahead.front();
      const bool is_in_frame = next.frame != 0 && next.frame == step.frame;
      const bool is_same_moment = std::abs(next.seen.scan.time_s - step.seen.scan.time_s) <= kSameMoment_s;
      if (!is_in_frame && (!is_same_moment || next.frame != 0 || next.motion.has_increment)) break;
      if (isChosen(next.seen.lidar)) {
        if (!isNew(next.seen.lidar)) break;
        others.push_back(std::move(next.seen));
      }
      motion.add(next.motion);
      ahead.pop_front();
    }
    for (auto& other : others)
      if (other.lidar == chosen.front()) std::swap(other, step.seen);
  }

  void requireLabelsFound() const {
    const auto& labels = steps.counts().scans_by_label;
    for (const auto& label : namedLidars(lidars_wanted)) {
      if (labels.count(label) || labels.empty()) continue;
      std::string found;
      for (const auto& [name, scans] : labels)
        found += (found.empty() ? "'" : ", '") + name + "' (" + std::to_string(scans) + " scans)";
      throw core::InputError(path + ": no laser scan with the sensor label '" + label + "', found " + found);
    }
  }

  std::string path;
  StepReader steps;
  std::string lidars_wanted;
  bool is_chosen = false;
  std::vector<std::string> chosen, remarks;
  std::vector<std::string> no_sweep;         ///< lidars whose stated sweep cannot be
  std::map<std::string, float> no_return_m;  ///< see unmarkedNoReturn()
  std::deque<Step> ahead;
  std::exception_ptr error_ahead;
  rawlogs::Motion motion;  ///< since the last entry
  bool is_first = true;
  core::Pose2 T_odom_robot;
};

LogReader::LogReader(const std::string& path, const std::string& lidars)
    : state_(std::make_unique<State>(path, lidars)) {}
LogReader::~LogReader() = default;

std::optional<LogEntry> LogReader::next() {
  if (!state_->is_chosen) state_->choose();
  while (auto step = state_->nextStep()) {
    state_->motion.add(step->motion);
    if (state_->isChosen(step->seen.lidar)) return state_->toEntry(std::move(*step));
  }
  state_->requireLabelsFound();
  return std::nullopt;
}

double LogReader::fractionRead() const {
  return state_->steps.fractionRead();
}
const LogCounts& LogReader::counts() const {
  return state_->steps.counts();
}
const std::string& LogReader::sensorLabel() const {
  static const std::string none;
  return state_->chosen.empty() ? none : state_->chosen.front();
}
const std::vector<std::string>& LogReader::lidars() const {
  return state_->chosen;
}
const std::vector<std::string>& LogReader::remarks() const {
  return state_->remarks;
}

}  // namespace slam::logs
