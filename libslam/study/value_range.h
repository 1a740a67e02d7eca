#pragma once
#include <string>
#include <vector>

#include "libslam/core/random.h"

namespace slam::study {

/// Values that a parameter may take: LOW..HIGH, or a list.
struct ValueRange {
  double low = 0, high = 0;
  int steps = 0;          ///< how many values between them, both ends included; 0: not said
  bool is_log = false;    ///< equal ratios instead of equal differences
  bool is_whole = false;  ///< both ends are written as whole numbers
  std::vector<std::string> list;
};

/// Reads `30..360`, `30..360:12` (steps, at least 2), `0.01..1:log`, `0.01..1:5:log`, or a list `1, 2, 5`
/// (any texts). Errors: InputError that begins with `place`: not one of these, high not above low, ends that
/// are not above 0 with log.
ValueRange readValueRange(const std::string& text, const std::string& place);

/// The values of a range from low to high, rounded to six digits; of a list its numbers in ascending order.
/// whole: rounded to whole numbers, those that fall together once. Errors: InputError that begins with
/// `place`: a list's text that is no number, or given twice.
std::vector<double> spacedValues(const ValueRange& range, int steps_if_not_said, bool whole,
                                 const std::string& place);

/// One value by chance, uniform over the range (its logarithm with log; the list's entries), as it stands in
/// an .ini, with four digits. A range between whole numbers gives whole numbers.
std::string drawValue(const ValueRange& range, core::RandomStream& random);

}  // namespace slam::study
