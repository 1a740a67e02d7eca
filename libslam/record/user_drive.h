#pragma once
#include <vector>

#include "libslam/record/record.h"
#include "libslam/robot/user_command.h"

namespace slam::record {

/// What became of a command.
struct CommandOutcome {
  robot::UserCommand command;
  double done = 0;        ///< what the robot truly did of it: metres or radians, with its sign
  bool collided = false;  ///< an obstacle ended it early; the rest of its time the robot stood there
};

struct UserDrive {
  Recording recording;
  /// Of the commands that were carried out, in their order. Those that are left found [simulation] duration_s
  /// over.
  std::vector<CommandOutcome> outcomes;
};

/// record() with a person's commands instead of a strategy: one command to the drive, one scan and one entry
/// of the operation log each, however far it goes; the first scan is taken before them. A command that meets
/// an obstacle stops there, and the next one is carried out all the same. Errors: as record().
UserDrive recordUserCommands(const world::Plan& given_plan, const RecordConfig& config, std::uint64_t seed,
                             const std::string& log_path, const std::vector<robot::UserCommand>& commands,
                             resources::Manifest manifest, core::Progress& progress,
                             StepObserver* observer = nullptr);

/// For people, where there is something to say: "line 3: move 1.5 ended at an obstacle after 0.82 m"; "" for
/// a command that was carried out whole.
std::string outcomeText(const CommandOutcome& outcome);

}  // namespace slam::record
