#include "libslam/logs/log_reader.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <deque>
#include <exception>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/logs/log_motion.h"
#include "libslam/logs/mrpt_objects.h"
#include "libslam/logs/mrpt_time.h"
#include "libslam/logs/object_stream.h"
#include "libslam/robot/mrpt_types.h"

namespace slam::logs {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CSensoryFrame;

constexpr size_t kScansToChooseLabel = 100;
/// A scan of whichever lidar with the motion since the scan before it, of whichever lidar.
struct Step {
  std::string label;
  robot::Scan scan;
  Motion motion;
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
    const auto increment = incrementOf(actions);
    if (!increment) return;
    requireFinite(*increment);
    ++counts_.odometry_readings;
    has_actions_ = true;
    motion_.add(*increment);
  }

  void takeFrame(const CSensoryFrame& frame) {
    // A frame is one moment: its odometry belongs to its scans wherever it stands among them.
    for (const auto& observation : frame)
      if (dynamic_cast<const CObservationOdometry*>(observation.get())) takeObservation(*observation);
    for (const auto& observation : frame)
      if (!dynamic_cast<const CObservationOdometry*>(observation.get())) takeObservation(*observation);
  }

  void takeObservation(const CObservation& observation) {
    if (const auto* scan = dynamic_cast<const CObservation2DRangeScan*>(&observation))
      takeScan(*scan);
    else if (const auto* odometry = dynamic_cast<const CObservationOdometry*>(&observation))
      takeReading(*odometry);
    else
      ++counts_.other_observations;
  }

  void takeReading(const CObservationOdometry& odometry) {
    noteStamp(odometry.timestamp);
    const auto pose = fromMrpt(odometry.odometry);
    requireFinite(pose);
    ++counts_.odometry_readings;
    if (has_actions_) return;
    bare_odometry_.add(ticksOf(odometry), pose);
  }

  void takeScan(const CObservation2DRangeScan& observation) {
    ++counts_.scans_by_label[observation.sensorLabel];
    std::int64_t ticks = ticksOf(observation);
    if (ticks == kNoStamp) ticks = newest_ticks_;
    if (ticks == kNoStamp)
      fail("laser scan without a time stamp, and no action or odometry before it has one");
    if (!has_actions_) motion_.add(bare_odometry_.takeUntil(ticks));
    Step step;
    step.label = observation.sensorLabel;
    try {
      step.scan = robot::fromMrpt(observation);
    } catch (const core::InputError& error) {
      fail(error.what());
    }
    step.scan.time_s = secondsFromMrptTicks(ticks);
    step.motion = std::exchange(motion_, Motion{});
    ready_.push_back(std::move(step));
  }

  void noteStamp(const mrpt::Clock::time_point& stamp) {
    if (stamp.time_since_epoch().count() != kNoStamp) newest_ticks_ = stamp.time_since_epoch().count();
  }

  void requireFinite(const core::Pose2& odometry) const {
    if (!core::isFinite(odometry)) fail("odometry that is not finite");
  }

  [[noreturn]] void fail(const std::string& what) const {
    throw core::InputError(path_ + ": " + objects_->place() + ": " + what);
  }

  std::string path_;
  std::unique_ptr<ObjectSource> objects_;
  LogCounts counts_;
  Motion motion_;
  bool has_actions_ = false;  ///< an action with an increment was met: bare readings count no more
  BareOdometry bare_odometry_;
  std::int64_t newest_ticks_ = kNoStamp;  ///< of an action or odometry reading
  std::deque<Step> ready_;
};

}  // namespace

struct LogReader::State {
  State(const std::string& log_path, const std::string& sensor_label)
      : path(log_path), steps(log_path), label(sensor_label), label_is_given(!sensor_label.empty()) {}

  /// Reads ahead, keeping an error for when the scans before it are used up.
  void chooseLabel() {
    label_is_chosen = true;
    if (label_is_given) return;
    try {
      while (ahead.size() < kScansToChooseLabel) {
        auto step = steps.next();
        if (!step) break;
        ahead.push_back(std::move(*step));
      }
    } catch (const core::InputError&) {
      error_ahead = std::current_exception();
    }
    std::map<std::string, size_t> scans;
    for (const Step& step : ahead) ++scans[step.label];
    size_t most = 0;
    for (const Step& step : ahead)
      if (scans[step.label] > most) most = scans[step.label], label = step.label;
  }

  std::optional<Step> nextStep() {
    if (!label_is_chosen) chooseLabel();
    if (!ahead.empty()) {
      Step step = std::move(ahead.front());
      ahead.pop_front();
      return step;
    }
    if (error_ahead) std::rethrow_exception(error_ahead);
    return steps.next();
  }

  LogEntry toEntry(Step&& step) {
    LogEntry entry;
    const Motion since_last = std::exchange(motion, Motion{});
    if (is_first) {
      entry.has_odometry = since_last.has_reading;
    } else {
      entry.has_odometry = since_last.has_increment;
      entry.T_previous_robot = since_last.T_previous_robot;
    }
    is_first = false;
    T_odom_robot = T_odom_robot * entry.T_previous_robot;
    entry.T_odom_robot = T_odom_robot;
    entry.scan = std::move(step.scan);
    return entry;
  }

  void requireLabelFound() const {
    const auto& labels = steps.counts().scans_by_label;
    if (!label_is_given || labels.count(label) || labels.empty()) return;
    std::string found;
    for (const auto& [name, scans] : labels)
      found += (found.empty() ? "'" : ", '") + name + "' (" + std::to_string(scans) + " scans)";
    throw core::InputError(path + ": no laser scan with the sensor label '" + label + "', found " + found);
  }

  std::string path;
  StepReader steps;
  std::string label;
  bool label_is_given, label_is_chosen = false;
  std::deque<Step> ahead;
  std::exception_ptr error_ahead;
  Motion motion;  ///< since the last entry
  bool is_first = true;
  core::Pose2 T_odom_robot;
};

LogReader::LogReader(const std::string& path, const std::string& sensor_label)
    : state_(std::make_unique<State>(path, sensor_label)) {}
LogReader::~LogReader() = default;

std::optional<LogEntry> LogReader::next() {
  while (auto step = state_->nextStep()) {
    state_->motion.add(step->motion);
    if (step->label == state_->label) return state_->toEntry(std::move(*step));
  }
  state_->requireLabelFound();
  return std::nullopt;
}

double LogReader::fractionRead() const {
  return state_->steps.fractionRead();
}
const LogCounts& LogReader::counts() const {
  return state_->steps.counts();
}
const std::string& LogReader::sensorLabel() const {
  return state_->label;
}

}  // namespace slam::logs
