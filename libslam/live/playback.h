#pragma once
#include <string>

namespace slam::live {

/// When the next step may be shown: paused, step by step, or so many times as fast as the robot's own time.
/// Plain arithmetic; what the clock says is given.
class Playback {
 public:
  static constexpr double kSlowest = 0.125, kFastest = 64;

  /// speed: 0 = as fast as it goes. REQUIRES 0 or kSlowest to kFastest (ContractError).
  explicit Playback(double speed, bool paused = false);

  bool paused() const { return paused_; }
  double speed() const { return speed_; }  ///< 0 = as fast as it goes
  void togglePause();
  void stepOnce();  ///< one more step, and pauses
  void faster();    ///< twice; above kFastest as fast as it goes
  void slower();

  /// Seconds to wait before the step after the robot's time `robot_s` may begin: 0 = now, infinity = until a
  /// key changes that. now_s: any steady clock. A computation that is late is not caught up with.
  double waitFor(double robot_s, double now_s);
  /// Told when a step has begun.
  void began();

  /// "paused", "4 x real time", "as fast as it goes"
  std::string text() const;

 private:
  double speed_;
  bool paused_;
  int steps_ = 0;  ///< asked for while paused
  bool is_anchored_ = false;
  double anchor_robot_s_ = 0, anchor_now_s_ = 0;
};

}  // namespace slam::live
