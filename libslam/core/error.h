#pragma once
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace slam::core {

/// What the program returns to the shell.
enum class ExitCode {
  kOk = 0,
  kFailed = 1,        ///< something of ours or of the machine went wrong
  kUsage = 2,         ///< the command line cannot be understood
  kBadInput = 3,      ///< a file, a key or a value from outside is wrong
  kMethodFailed = 4,  ///< a SLAM method failed or diverged on good input
  kGotWorse = 5,      ///< figures are worse than a gate allows
  kCellsFailed = 6,   ///< cells of a sweep failed or are missing
  kInterrupted = 130
};

/// Something from outside is wrong. what() is one line: where (file, section, key, line or byte), what was
/// found, what was expected. Example: "plan.yaml: key 'resolution': found '-0.05', expected a number above
/// 0".
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The machine refused: a file cannot be written, the disk is full. what() is one line with the path.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A method gave up or diverged on input that is good.
class MethodError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller broke a documented precondition: a bug in the calling code.
class ContractError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// The user asked to stop (Ctrl-C). Thrown by Progress::update(); everything half-written is removed on the
/// way up.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

/// A message as one line for a terminal, whatever names and bytes of files it quotes: line breaks become
/// blanks, other control bytes and what is no UTF-8 become hexadecimal escapes, and what is longer than
/// `most` bytes loses its middle ("...").
std::string oneLine(std::string_view message, std::size_t most = 300);

/// A text as a terminal can show it: control bytes but line breaks and tabs, and what is no UTF-8, become
/// hexadecimal escapes ("\x1b").
std::string printable(std::string_view text);

/// "; did you mean 'x'?" for the candidate nearest to word by edit distance, or "" when none is near
/// (more than a third of its letters, rounded up, would have to change).
std::string didYouMean(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace slam::core
