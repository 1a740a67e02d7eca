#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/robot/drive.h"

namespace slam::robot {

/// A command as a person gives it: the original robot's move(step) or turn(angle).
struct UserCommand {
  enum Kind { kMove, kTurn } kind = kMove;
  double amount = 0;  ///< move: metres, negative backwards; turn: radians, counter-clockwise positive
  int line = 0;       ///< of the file that it stands in
};

/// One line: "move 1.5" in metres or "turn 25" in degrees, '#' begins a comment. nullopt for a line with
/// neither. Errors: InputError for anything else, for 0, for more than 1000 m or 360 degrees; `where` stands
/// before it.
std::optional<UserCommand> parseUserCommand(const std::string& line, const std::string& where);

/// All lines of a text; `name` stands for the file in errors. Errors: as above, with the line; InputError
/// when there is no command at all.
std::vector<UserCommand> parseUserCommands(const std::string& text, const std::string& name);

/// "move 1.5", "turn 25": the line that it is read from.
std::string formatUserCommand(const UserCommand& command);

/// The whole of it as one command to the drive, at full speed.
Command toCommand(const UserCommand& command, const RobotOptions& robot);

}  // namespace slam::robot
