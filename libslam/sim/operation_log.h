#pragma once
#include <string>
#include <vector>

namespace slam::sim {

/// The founding document's operation log: `m` with the two move readings (rear, front), or `t` with the turn
/// reading, as the scan-difference odometry estimated them, one line per command:
///
///     m 0.5 0.49
///     t -0.017453292519943295
///
/// Metres and radians, written so that they read back as the same numbers.
struct Operation {
  char kind;          ///< 'm' or 't'
  double first;       ///< m: rear reading in metres; t: angle in radians
  double second = 0;  ///< m: front reading in metres; t: unused
};

/// REQUIRES known kinds and finite readings (ContractError). No operation gives the empty text.
std::string formatOperations(const std::vector<Operation>& operations);

/// Reads what formatOperations wrote; `name` stands for the file in errors. InputError with file and line
/// for anything else: another letter, too few or too many readings, a reading that is not a finite number, an
/// empty line, a last line without its end (the log was cut short).
std::vector<Operation> parseOperations(const std::string& text, const std::string& name);

}  // namespace slam::sim
