#pragma once
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

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

/// One line, with its end. REQUIRES a known kind and finite readings (ContractError).
std::string formatOperation(const Operation& operation);
/// All lines. No operation gives the empty text.
std::string formatOperations(const std::vector<Operation>& operations);

/// Reads what formatOperations wrote; `name` stands for the file in errors. InputError with file and line
/// for anything else: another letter, too few or too many readings, a reading that is not a finite number, an
/// empty line, a last line without its end (the log was cut short).
std::vector<Operation> parseOperations(const std::string& text, const std::string& name);

/// The founding system's dead reckoning, replayed: from the identity, `t` turns in place by the angle, `m` goes
/// along the heading by the mean of front and minus rear reading, or by the one that is not 0: the log writes 0
/// for a reading that there was none of (a beam without a return, a lidar that does not look back). A reading
/// that was truly 0 beside one that was not counts as none too; noise makes that a chance of about one in 10^4
/// moves. One pose more than operations, the start first; stamps count operations (0, 1, 2, ...), for the log
/// has no clock.
core::Trajectory replayOperations(const std::vector<Operation>& operations);

}  // namespace slam::sim
