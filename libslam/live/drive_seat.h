#pragma once
#include <deque>
#include <optional>
#include <vector>

#include "libslam/live/hand_drive.h"
#include "libslam/live/stage.h"
#include "libslam/record/record.h"
#include "libslam/robot/user_command.h"

namespace slam::live {

/// What `view drive` does next: the commands of a file, then whole commands that are typed, else what the
/// held keys say for a period. A robot that is dragged is kidnapped before that.
class DriveSeat {
 public:
  /// stage: of the window; nullptr without one, then the drive ends after `commands`. REQUIRES that it
  /// outlives this. ends: after `commands` also with a window.
  DriveSeat(const robot::RobotOptions& robot, double period_s,
            const std::vector<robot::UserCommand>& commands, Stage* stage, bool ends);

  /// nullopt ends the drive; what was typed or dragged before the window was closed is done first.
  /// `collided`: the last command ended at an obstacle.
  std::optional<record::Order> next(bool collided);

 private:
  robot::RobotOptions robot_;
  HandDrive hand_;
  std::deque<robot::UserCommand> commands_;
  Stage* stage_;
  bool ends_;
};

}  // namespace slam::live
