#pragma once
#include <cstddef>
#include <string>

#include "libslam/table/table.h"

namespace slam::table {

/// toText() for a terminal of another width (toText() is for 80). Where the columns are wider, first the
/// titles are broken over lines at blanks, then texts longer than 28 letters inside the cells; what is still
/// too wide is set in blocks below one another, each with the columns that name the row repeated on the left:
/// the leading ones that hold text, as many as leave room for figures. Only a single column that is too wide
/// by itself goes over the edge. Caption and notes are broken at 80 at the latest.
std::string toTextWithin(const Table& table, std::size_t width);

}  // namespace slam::table
