#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/robot/motion_kind.h"

namespace slam::sim {

/// The original document's operation log: `m` with the two move readings (rear, front), or `t` with the turn
/// reading, as the scan-difference odometry estimated them, one line per command, and after the readings the
/// numbers of the scans before and after it in the log (the first is 0):
///
///     m -0.5 0.49 0 6
///     t -0.017453292519943295 6 7
///     a -0.5 0.5 0.25 9 10
///
/// Metres and radians, written so that they read back as the same numbers. Where it differs from the original
/// (original_log.h): one line instead of two or three, metres and radians instead of whole pixels and
/// degrees, and
///   - the numbers of the scans, because our logs hold scans taken during a command, and at rest, which is no
///     command. They may be left out of a whole log: then every operation leads from one scan to the next;
///   - `a` rear, front, turn: an arc, for which the original robot has no command. The readings are along its
///     chord.
struct Operation {
  char kind;                                      ///< 'm', 't' or 'a'
  double first;                                   ///< m, a: rear reading in metres; t: angle in radians
  double second = 0;                              ///< m, a: front reading in metres; t: unused
  double third = 0;                               ///< a: angle in radians; m, t: unused
  std::uint64_t scan_before = 0, scan_after = 0;  ///< both 0: not given
};

/// One line, with its end. REQUIRES a known kind, finite readings, and scan_before < scan_after or both 0
/// (ContractError).
std::string formatOperation(const Operation& operation);
/// All lines. No operation gives the empty text.
std::string formatOperations(const std::vector<Operation>& operations);

/// Reads what formatOperations wrote; `name` stands for the file in errors. InputError with file and line
/// for anything else: another letter, too few or too many readings, a reading that is not a finite number,
/// scan numbers that run back or that only some lines have, an
/// empty line, a last line without its end (the log was cut short).
std::vector<Operation> parseOperations(const std::string& text, const std::string& name);

/// The original system's dead reckoning, replayed: from the identity, `t` turns in place by the angle, `m`
/// goes along the heading by the mean of front and minus rear reading, or by the one that is not 0: the log
/// writes 0 for a reading that there was none of (a beam without a return, a lidar that does not look back);
/// `a` turns by half, goes, and turns by the other half. A reading
/// that was truly 0 beside one that was not counts as none too; noise makes that a chance of about one in
/// 10^4 moves. One pose more than operations, the start first; stamps count operations (0, 1, 2, ...), for
/// the log has no clock.
core::Trajectory replayOperations(const std::vector<Operation>& operations);

/// What the robot was told to do before each of `scans` scans, the first at rest, as the log's numbers have
/// it: scans that no operation covers were taken at rest. `name` stands for the file in errors. InputError
/// when the two do not belong together: an operation beyond the last scan; without numbers, more or fewer
/// than one operation between two scans.
std::vector<robot::Commanded> commandsOfScans(const std::vector<Operation>& operations, std::uint64_t scans,
                                              const std::string& name);

}  // namespace slam::sim
