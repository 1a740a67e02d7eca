#pragma once
#include <optional>
#include <string>

#include "libslam/robot/user_command.h"

namespace slam::live {

/// A line in the window to type a command in: "move 1.5", "turn 25". Plain text; the window gives it the
/// keys.
class CommandLine {
 public:
  bool isOpen() const { return is_open_; }
  void open();
  void close();
  /// A character that was typed; what is not printable ASCII is left out, and so is what follows 60
  /// characters.
  void type(unsigned codepoint);
  /// Takes the last character back.
  void erase();
  /// The line is complete: the command, and the line closes. A line that is none stays open, to be mended,
  /// and refusal() says why; an empty one only closes.
  std::optional<robot::UserCommand> enter();

  /// "> move 1.5_"; "" while it is closed.
  std::string text() const { return is_open_ ? "> " + text_ + "_" : ""; }
  /// Why the line was refused; "" once it is changed.
  const std::string& refusal() const { return refusal_; }

 private:
  bool is_open_ = false;
  std::string text_, refusal_;
};

}  // namespace slam::live
