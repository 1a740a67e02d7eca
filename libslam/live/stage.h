#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>

#include "libslam/live/hand_drive.h"
#include "libslam/live/playback.h"
#include "libslam/live/snapshot_maker.h"
#include "libslam/record/step_observer.h"
#include "libslam/robot/user_command.h"
#include "libslam/viewer/snapshot.h"

namespace slam::live {

/// What a loop in one thread and a window in another share. All of it is safe to call from either.
class Stage {
 public:
  explicit Stage(const Playback& playback) : playback_(playback) {}

  // The window's side.
  /// The newest moment, once.
  std::optional<viewer::Snapshot> take();
  /// A change of the playback: the loop hears of it at once.
  void change(const std::function<void(Playback&)>& change);
  std::string playbackText() const;
  void setKeys(const HeldKeys& keys);
  /// A whole command that was typed; they are carried out one after the other.
  void give(const robot::UserCommand& command);
  /// The robot is put down there, world frame, before the next command; a place that is free by the plan.
  void carry(const core::Pose2& T_world_robot);
  /// The window is closed: the loop is to end.
  void close();
  bool isFinished() const;  ///< the loop has ended

  // The loop's side.
  void publish(viewer::Snapshot snapshot);
  bool isWanted() const;  ///< the last moment was taken
  /// Waits until the step after the robot's time may begin. while_paused is called once when there is time
  /// for it. Returns false when the window was closed.
  bool waitForStep(double robot_s, const std::function<void()>& while_paused);
  HeldKeys keys() const;
  /// The next command that was typed, once.
  std::optional<robot::UserCommand> takeCommand();
  /// Where the robot was last put down, once.
  std::optional<core::Pose2> takeCarry();
  bool isClosed() const;
  void finish();

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<viewer::Snapshot> next_;
  Playback playback_;
  HeldKeys keys_;
  std::deque<robot::UserCommand> commands_;
  std::optional<core::Pose2> T_world_carried_;
  bool closed_ = false, finished_ = false;
};

/// Puts what a loop does on a stage, at the stage's pace.
class StagedLoop : public record::StepObserver {
 public:
  /// closing_interrupts: a closed window ends the loop by core::Interrupted; else the loop has to ask
  /// isClosed() itself.
  StagedLoop(Stage& stage, SnapshotMaker& maker, bool closing_interrupts)
      : stage_(stage), maker_(maker), closing_interrupts_(closing_interrupts) {}
  void onStep(const record::Step& step) override;
  void onFinished(const mapping::MapBuilder& method) override;

 private:
  void publish(const mapping::MapBuilder* method, bool with_map);

  Stage& stage_;
  SnapshotMaker& maker_;
  bool closing_interrupts_;
  double map_at_s_ = -1, map_cost_s_ = 0;  ///< by the clock: when a map was last asked for, and what it cost
};

/// Stops a loop at a time of the robot's and keeps that moment.
class MomentAt : public record::StepObserver {
 public:
  MomentAt(SnapshotMaker& maker, double time_s) : maker_(maker), time_s_(time_s) {}
  /// Throws core::Interrupted once the moment is there.
  void onStep(const record::Step& step) override;
  const std::optional<viewer::Snapshot>& moment() const { return moment_; }

 private:
  SnapshotMaker& maker_;
  double time_s_;
  std::optional<viewer::Snapshot> moment_;
};

}  // namespace slam::live
