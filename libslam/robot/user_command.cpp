#include "libslam/robot/user_command.h"

#include <cmath>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/files/ini.h"
#include "libslam/files/parameters.h"

namespace slam::robot {
namespace {

// More is a slip of the hand: no plan is so wide, and a turn comes round.
constexpr double kFarthest_m = 1000, kFarthest_deg = 360;

}  // namespace

std::optional<UserCommand> parseUserCommand(const std::string& line, const std::string& where) {
  const std::string text = files::trimmed(line.substr(0, line.find('#')));
  if (text.empty()) return std::nullopt;
  std::istringstream words(text);
  std::string kind, amount, more;
  words >> kind >> amount;
  double number = 0;
  const bool is_turn = kind == "turn";
  const double farthest = is_turn ? kFarthest_deg : kFarthest_m;
  const bool is_good = (is_turn || kind == "move") && files::parseNumber(amount, number) &&
                       !(words >> more) && number != 0 && std::abs(number) <= farthest;
  if (!is_good)
    throw core::InputError(where + ": found '" + text +
                           "', expected 'move METRES' (up to 1000) or 'turn DEGREES' (up to 360), and not 0");
  return UserCommand{is_turn ? UserCommand::kTurn : UserCommand::kMove,
                     is_turn ? core::degToRad(number) : number, 0};
}

std::vector<UserCommand> parseUserCommands(const std::string& text, const std::string& name) {
  std::vector<UserCommand> commands;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    auto command = parseUserCommand(line, name + ":" + std::to_string(number));
    if (!command) continue;
    command->line = number;
    commands.push_back(*command);
  }
  if (commands.empty())
    throw core::InputError(name + ": holds no command, expected 'move METRES' or 'turn DEGREES' on lines");
  return commands;
}

std::string formatUserCommand(const UserCommand& command) {
  if (command.kind == UserCommand::kMove) return "move " + files::formatNumber(command.amount);
  // A degree is no whole number of radians: what was typed comes back when rounded to what can be typed.
  return "turn " + files::formatNumber(std::round(core::radToDeg(command.amount) * 1e9) / 1e9);
}

Command toCommand(const UserCommand& command, const RobotOptions& robot) {
  return command.kind == UserCommand::kMove ? moveCommand(robot, command.amount)
                                            : turnCommand(robot, command.amount);
}

}  // namespace slam::robot
