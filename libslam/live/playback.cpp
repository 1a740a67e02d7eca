#include "libslam/live/playback.h"

#include <algorithm>
#include <limits>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::live {

Playback::Playback(double speed, bool paused) : speed_(speed), paused_(paused) {
  if (!(speed == 0 || (speed >= kSlowest && speed <= kFastest)))
    throw core::ContractError("Playback: a speed of 0, or from 0.125 to 64");
}

void Playback::togglePause() {
  paused_ = !paused_;
  steps_ = 0;
  is_anchored_ = false;
}

void Playback::stepOnce() {
  if (paused_) ++steps_;
  paused_ = true;
}

void Playback::faster() {
  speed_ = speed_ == 0 || speed_ * 2 > kFastest ? 0 : speed_ * 2;
  is_anchored_ = false;
}

void Playback::slower() {
  speed_ = speed_ == 0 ? kFastest : std::max(kSlowest, speed_ / 2);
  is_anchored_ = false;
}

double Playback::waitFor(double robot_s, double now_s) {
  if (paused_) return steps_ > 0 ? 0 : std::numeric_limits<double>::infinity();
  if (speed_ == 0) return 0;
  const double due_s = anchor_now_s_ + (robot_s - anchor_robot_s_) / speed_;
  if (!is_anchored_ || due_s < now_s) {
    is_anchored_ = true;
    anchor_robot_s_ = robot_s, anchor_now_s_ = now_s;
    return 0;
  }
  return due_s - now_s;
}

void Playback::began() {
  if (paused_ && steps_ > 0) --steps_;
}

std::string Playback::text() const {
  if (paused_) return "paused";
  if (speed_ == 0) return "as fast as it goes";
  return files::formatNumber(speed_) + " x real time";
}

}  // namespace slam::live
