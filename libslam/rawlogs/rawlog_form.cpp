#include "libslam/rawlogs/rawlog_form.h"

#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <algorithm>
#include <deque>
#include <utility>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/objects/mrpt_objects.h"
#include "libslam/objects/mrpt_time.h"
#include "libslam/rawlogs/log_motion.h"

namespace slam::rawlogs {
namespace {

using mrpt::obs::CActionCollection;
using mrpt::obs::CObservation;
using mrpt::obs::CObservation2DRangeScan;
using mrpt::obs::CObservationOdometry;
using mrpt::obs::CSensoryFrame;
using Object = std::shared_ptr<mrpt::serialization::CSerializable>;

/// A step between a source and whoever reads it.
class Step : public objects::ObjectSource {
 public:
  Step(std::unique_ptr<objects::ObjectSource> source, std::string path)
      : source_(std::move(source)), path_(std::move(path)) {}

  Object next() override {
    while (ready_.empty() && !ended_) {
      if (auto object = source_->next()) {
        take(std::move(object));
      } else {
        ended_ = true;
        finish();
      }
    }
    if (ready_.empty()) return nullptr;
    auto object = std::move(ready_.front());
    ready_.pop_front();
    ++count_;
    return object;
  }
  std::uint64_t count() const override { return count_; }
  double fractionRead() const override { return source_->fractionRead(); }
  std::string place() const override { return source_->place(); }
  std::string skipped() const override {
    std::string text = source_->skipped();
    const auto add = [&text](std::uint64_t number, const char* what) {
      if (number > 0) text += (text.empty() ? "" : "; ") + std::to_string(number) + " " + what;
    };
    add(other_readings_, "odometry readings beside actions");
    add(no_observations_, "objects that are no observations");
    return text;
  }

 protected:
  virtual void take(Object object) = 0;
  virtual void finish() = 0;

  void give(Object object) { ready_.push_back(std::move(object)); }
  void requireFinite(const core::Pose2& odometry) const {
    if (!core::isFinite(odometry))
      throw core::InputError(path_ + ": " + source_->place() + ": odometry that is not finite");
  }
  void countOtherReading() { ++other_readings_; }
  void countNoObservation() { ++no_observations_; }

 private:
  std::unique_ptr<objects::ObjectSource> source_;
  std::string path_;
  std::deque<Object> ready_;
  std::uint64_t count_ = 0, other_readings_ = 0, no_observations_ = 0;
  bool ended_ = false;
};

class ToFrames : public Step {
 public:
  using Step::Step;

 private:
  static constexpr size_t kMostWithoutScan = 1000;

  void take(Object object) override {
    if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object)) {
      has_actions_ = has_actions_ || incrementOf(*actions).has_value();
      give(actions);
    } else if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
      for (auto& other : std::exchange(others_, {})) frame->insert(other);
      give(frame);
    } else if (const auto odometry = std::dynamic_pointer_cast<CObservationOdometry>(object)) {
      takeReading(*odometry);
    } else if (const auto observation = std::dynamic_pointer_cast<CObservation>(object)) {
      takeObservation(observation);
    } else {
      countNoObservation();
    }
  }

  void takeReading(const CObservationOdometry& odometry) {
    if (has_actions_) return countOtherReading();
    requireFinite(objects::fromMrpt(odometry.odometry));
    const auto ticks = objects::ticksOf(odometry);
    if (ticks != objects::kNoStamp) newest_ticks_ = ticks;
    odometry_.add(ticks, objects::fromMrpt(odometry.odometry));
  }

  void takeObservation(const CObservation::Ptr& observation) {
    const bool is_scan = std::dynamic_pointer_cast<CObservation2DRangeScan>(observation) != nullptr;
    others_.push_back(observation);
    // icp-slam stops at a frame whose first observation has no stamp.
    if (is_scan && objects::ticksOf(*others_.front()) == objects::kNoStamp)
      std::rotate(others_.begin(), others_.end() - 1, others_.end());
    if (is_scan)
      giveFrame(actionsOf(*observation));
    else if (others_.size() >= kMostWithoutScan)
      finish();
  }

  CActionCollection::Ptr actionsOf(const CObservation& scan) {
    auto actions = std::make_shared<CActionCollection>();
    const auto stamp = objects::ticksOf(scan) == objects::kNoStamp ? newest_ticks_ : objects::ticksOf(scan);
    const Motion motion = odometry_.takeUntil(stamp);
    const bool is_first = std::exchange(is_first_, false);
    if (has_actions_ || !(is_first ? motion.has_reading : motion.has_increment)) return actions;
    const auto increment = is_first ? core::Pose2{} : motion.T_previous_robot;
    actions->insert(objects::wheelAction(increment, stamp));
    return actions;
  }

  void giveFrame(CActionCollection::Ptr actions) {
    auto frame = std::make_shared<CSensoryFrame>();
    for (auto& other : std::exchange(others_, {})) frame->insert(other);
    give(std::move(actions));
    give(std::move(frame));
  }

  void finish() override {
    if (!others_.empty()) giveFrame(std::make_shared<CActionCollection>());
  }

  BareOdometry odometry_;
  std::vector<CObservation::Ptr> others_;  ///< that stand before the next scan
  std::int64_t newest_ticks_ = objects::kNoStamp;
  bool has_actions_ = false, is_first_ = true;
};

class ToObservations : public Step {
 public:
  using Step::Step;

 private:
  void take(Object object) override {
    if (const auto actions = std::dynamic_pointer_cast<CActionCollection>(object)) {
      takeActions(*actions);
    } else if (const auto frame = std::dynamic_pointer_cast<CSensoryFrame>(object)) {
      giveOdometry(stampOf(*frame));
      for (const auto& observation : *frame) giveObservation(observation);
    } else if (const auto observation = std::dynamic_pointer_cast<CObservation>(object)) {
      giveObservation(observation);
    } else {
      countNoObservation();
    }
  }

  void takeActions(const CActionCollection& actions) {
    for (const auto& action : actions)
      if (objects::ticksOf(*action) != objects::kNoStamp) action_ticks_ = objects::ticksOf(*action);
    const auto increment = incrementOf(actions);
    if (!increment) return;
    requireFinite(*increment);
    T_odom_robot_ = T_odom_robot_ * *increment;
    has_actions_ = has_news_ = true;
  }

  std::int64_t stampOf(const CSensoryFrame& frame) const {
    std::int64_t ticks = objects::kNoStamp;
    for (const auto& observation : frame) {
      const bool is_scan = dynamic_cast<const CObservation2DRangeScan*>(observation.get()) != nullptr;
      if (is_scan && objects::ticksOf(*observation) != objects::kNoStamp)
        return objects::ticksOf(*observation);
      if (ticks == objects::kNoStamp) ticks = objects::ticksOf(*observation);
    }
    return ticks == objects::kNoStamp ? action_ticks_ : ticks;
  }

  void giveOdometry(std::int64_t ticks) {
    if (std::exchange(has_news_, false))
      give(objects::makeOdometry(T_odom_robot_, ticks, objects::kOdometryLabel));
  }

  void giveObservation(const CObservation::Ptr& observation) {
    if (has_actions_ && std::dynamic_pointer_cast<CObservationOdometry>(observation))
      countOtherReading();
    else
      give(observation);
  }

  void finish() override { giveOdometry(action_ticks_); }

  core::Pose2 T_odom_robot_;
  std::int64_t action_ticks_ = objects::kNoStamp;
  bool has_actions_ = false, has_news_ = false;
};

}  // namespace

std::unique_ptr<objects::ObjectSource> inForm(std::unique_ptr<objects::ObjectSource> source, RawlogForm form,
                                              const std::string& path) {
  if (form == RawlogForm::kActionFrame) return std::make_unique<ToFrames>(std::move(source), path);
  return std::make_unique<ToObservations>(std::move(source), path);
}

}  // namespace slam::rawlogs
