#pragma once
#include <map>
#include <string>

#include "libslam/table/table.h"

namespace slam::table {

/// Which value of a column is the best one.
enum class Best { kSmallest, kLargest };

struct LatexOptions {
  std::string label;                 ///< to refer to, as tab:scores; "" for none
  std::map<std::string, Best> best;  ///< by the columns' keys; of numbers
};

/// A table float with booktabs' rules (needs the package booktabs; UTF-8): caption, label, tabular, notes in
/// small print. It fits the text of the class article at 10pt: in the largest type that does, titles broken
/// at blanks; where none does, in parts below one another, each with the leading columns of text. Units at
/// the ends of titles stand in brackets. In bold the best of each column that has one: as shown, so that
/// equal ones are all best, and none where all are equal. What LaTeX would read as a command is escaped; "--"
/// is NaN, a minus sign and infinity are set as mathematics.
std::string toLatex(const Table& table, const LatexOptions& options);

}  // namespace slam::table
