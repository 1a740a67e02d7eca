#include "libslam/live/command_line.h"

#include "libslam/core/error.h"

namespace slam::live {
namespace {

constexpr size_t kLongest = 60;

}  // namespace

void CommandLine::open() {
  is_open_ = true;
}

void CommandLine::close() {
  *this = {};
}

void CommandLine::type(unsigned codepoint) {
  if (!is_open_ || codepoint < ' ' || codepoint > '~' || text_.size() >= kLongest) return;
  text_ += static_cast<char>(codepoint);
  refusal_.clear();
}

void CommandLine::erase() {
  if (!text_.empty()) text_.pop_back();
  refusal_.clear();
}

std::optional<robot::UserCommand> CommandLine::enter() {
  try {
    const auto command = robot::parseUserCommand(text_, "the line");
    close();
    return command;
  } catch (const core::InputError&) {
    refusal_ = "expected: move METRES, or turn DEGREES";
    return std::nullopt;
  }
}

}  // namespace slam::live
