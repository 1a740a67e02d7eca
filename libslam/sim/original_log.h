#pragma once
#include <string>
#include <vector>

#include "libslam/sim/operation_log.h"

namespace slam::sim {

/// How the original's numbers become ours.
struct OriginalUnits {
  double pixel_m = 0.05;   ///< one pixel of its picture
  bool clockwise = false;  ///< indices of its scans, and so its turns, grow clockwise as seen on the map
};

/// The operation log as the original document has it: every command in lines of its own, `m`, rear reading,
/// front reading, or `t`, angle; whole pixels and whole degrees, nothing else:
///
///     m
///     -10
///     10
///     t
///     -25
///
/// Readings are of the scan before minus the scan after, as ours. An arc, which the original does not have,
/// is written as half its turn, its move, and what is left of its turn. Numbers are rounded to the nearest,
/// halves away from zero; the numbers of scans are lost. REQUIRES a positive pixel (ContractError).
std::string formatOriginalLog(const std::vector<Operation>& operations, const OriginalUnits& units);

/// Reads it; operations come without scan numbers. `name` stands for the file in errors. InputError with file
/// and line for another letter, a number that is not whole, or a log that ends within a command; a last line
/// need not end.
std::vector<Operation> parseOriginalLog(const std::string& text, const OriginalUnits& units,
                                        const std::string& name);

/// Whether a text is of this form rather than ours: its first line is a letter m or t alone. The empty text
/// is not.
bool isOriginalLog(const std::string& text);

}  // namespace slam::sim
