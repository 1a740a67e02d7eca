#include "libslam/edit/log_steps.h"

#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CActionRobotMovement3D.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPosePDFGaussian.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"
#include "libslam/logs/log_format.h"

namespace slam::edit {
namespace {

using mrpt::obs::CAction;
using mrpt::obs::CActionCollection;
using mrpt::obs::CActionRobotMovement2D;
using mrpt::obs::CActionRobotMovement3D;
using mrpt::obs::CObservation;
using mrpt::obs::CSensoryFrame;
using mrpt::serialization::CSerializable;

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

}  // namespace

StepReader::StepReader(const std::string& path) {
  if (logs::detectLogFormat(path) == logs::LogFormat::kRawlog) {
    auto rawlog = std::make_unique<rawlogs::RawlogObjects>(path);
    rawlog_ = rawlog.get();
    source_ = std::move(rawlog);
  } else {
    source_ = logs::openLog(path);
  }
}

std::optional<LogStep> StepReader::next() {
  LogStep step;
  while (const auto content = source_->next()) {
    LogObject object{content, rawlog_ ? rawlog_->bytes() : ""};
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

void StepReader::setTime(LogStep& step) {
  if (step.rest) step.ticks = ticksOf(*step.rest->content);
  for (const auto& action : step.actions)
    if (step.ticks == objects::kNoStamp) step.ticks = ticksOf(*action.content);
}

void ComposedActions::add(const CActionCollection& actions) {
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

std::shared_ptr<CActionCollection> ComposedActions::collection() const {
  auto result = CActionCollection::Create();
  if (wheels_) result->insert(*wheels_);
  if (matched_) result->insert(*matched_);
  if (spatial_) result->insert(*spatial_);
  for (const auto& action : others_) result->insert(*action);
  return result;
}

void ComposedActions::addWheels(const CActionRobotMovement2D& next) {
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

void ComposedActions::addMatched(const CActionRobotMovement2D& next) {
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

void ComposedActions::addSpatial(const CActionRobotMovement3D& next) {
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

void StepWriter::write(const LogStep& step) {
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

void StepWriter::drop(const LogStep& step) {
  for (const auto& actions : step.actions) take(actions);
}

void StepWriter::close(std::uint64_t read) {
  const std::uint64_t written = counts_.unchanged + counts_.changed;
  if (written == 0)
    throw core::InputError(path_ + ": nothing would be left of " + std::to_string(read) +
                           " objects, expected at least one");
  counts_.read = read;
  counts_.dropped = read - written;
  stream_.close();
  pending_.commit();
}

void StepWriter::take(const LogObject& actions) {
  if (!dropped_) dropped_.emplace();
  dropped_->add(dynamic_cast<const CActionCollection&>(*actions.content));
}

void StepWriter::write(const LogObject& object) {
  if (object.bytes.empty())
    serialize(*object.content);
  else
    stream_.Write(object.bytes.data(), object.bytes.size());
  ++(object.is_changed ? counts_.changed : counts_.unchanged);
}

void StepWriter::serialize(const CSerializable& object) {
  try {
    mrpt::serialization::archiveFrom<mrpt::io::CStream>(stream_) << object;
  } catch (const std::exception&) {
    stream_.rethrowFailure();
    throw;
  }
}

}  // namespace slam::edit
