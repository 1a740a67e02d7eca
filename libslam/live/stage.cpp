#include "libslam/live/stage.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "libslam/core/error.h"

namespace slam::live {
namespace {

constexpr double kBetweenMaps_s = 0.2;      // by the clock: faster than anybody looks
constexpr double kMostOfTimeForMaps = 0.1;  // of the loop's
constexpr double kLongestWait_s = 3600;

double clock_s() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::optional<viewer::Snapshot> Stage::take() {
  const std::lock_guard lock(mutex_);
  auto taken = std::move(next_);
  next_.reset();
  return taken;
}

void Stage::change(const std::function<void(Playback&)>& change) {
  {
    const std::lock_guard lock(mutex_);
    change(playback_);
  }
  changed_.notify_all();
}

std::string Stage::playbackText() const {
  const std::lock_guard lock(mutex_);
  return finished_ ? "finished" : playback_.text();
}

void Stage::setKeys(const HeldKeys& keys) {
  const std::lock_guard lock(mutex_);
  keys_ = keys;
}

void Stage::give(const robot::UserCommand& command) {
  const std::lock_guard lock(mutex_);
  commands_.push_back(command);
}

void Stage::carry(const core::Pose2& T_world_robot) {
  const std::lock_guard lock(mutex_);
  T_world_carried_ = T_world_robot;
}

void Stage::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

bool Stage::isFinished() const {
  const std::lock_guard lock(mutex_);
  return finished_;
}

void Stage::publish(viewer::Snapshot snapshot) {
  const std::lock_guard lock(mutex_);
  next_ = std::move(snapshot);
}

bool Stage::isWanted() const {
  const std::lock_guard lock(mutex_);
  return !next_;
}

bool Stage::waitForStep(double robot_s, const std::function<void()>& while_paused) {
  std::unique_lock lock(mutex_);
  bool is_told = false;
  while (!closed_) {
    const double wait_s = playback_.waitFor(robot_s, clock_s());
    if (wait_s <= 0) {
      playback_.began();
      return true;
    }
    if (playback_.paused() && !is_told) {
      is_told = true;
      lock.unlock();
      while_paused();
      lock.lock();
      continue;
    }
    changed_.wait_for(lock, std::chrono::duration<double>(std::min(wait_s, kLongestWait_s)));
  }
  return false;
}

HeldKeys Stage::keys() const {
  const std::lock_guard lock(mutex_);
  return keys_;
}

std::optional<robot::UserCommand> Stage::takeCommand() {
  const std::lock_guard lock(mutex_);
  if (commands_.empty()) return std::nullopt;
  const auto command = commands_.front();
  commands_.pop_front();
  return command;
}

std::optional<core::Pose2> Stage::takeCarry() {
  const std::lock_guard lock(mutex_);
  const auto carried = T_world_carried_;
  T_world_carried_.reset();
  return carried;
}

bool Stage::isClosed() const {
  const std::lock_guard lock(mutex_);
  return closed_;
}

void Stage::finish() {
  const std::lock_guard lock(mutex_);
  finished_ = true;
}

void StagedLoop::publish(const mapping::MapBuilder* method, bool with_map) {
  const double before_s = clock_s();
  stage_.publish(maker_.snapshot(method, with_map));
  if (!with_map) return;
  map_at_s_ = clock_s();
  map_cost_s_ = map_at_s_ - before_s;
}

void StagedLoop::onStep(const record::Step& step) {
  maker_.add(step);
  if (stage_.isWanted()) {
    const double since_s = clock_s() - map_at_s_;
    publish(step.method, since_s > std::max(kBetweenMaps_s, map_cost_s_ / kMostOfTimeForMaps));
  }
  const bool goes_on = stage_.waitForStep(step.time_s, [&] { publish(step.method, true); });
  if (!goes_on && closing_interrupts_) throw core::Interrupted();
}

void StagedLoop::onFinished(const mapping::MapBuilder& method) {
  publish(&method, true);
}

void MomentAt::onStep(const record::Step& step) {
  maker_.add(step);
  if (step.time_s < time_s_ - 1e-6) return;
  moment_ = maker_.snapshot(step.method, true);
  throw core::Interrupted();
}

}  // namespace slam::live
