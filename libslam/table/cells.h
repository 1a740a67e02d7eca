#pragma once
#include <cstddef>
#include <string>

#include "libslam/table/table.h"

namespace slam::table {

/// Index of the column with that key. Errors: InputError that begins with the path of the table's file, and
/// names the nearest key.
std::size_t columnOf(const Table& table, const std::string& key, const std::string& path);
/// A cell as text: of a number the digits that read back the same, "" for NaN.
std::string textOf(const CellValue& cell);
/// A cell as a number: NaN where it holds text.
double numberOf(const CellValue& cell);

}  // namespace slam::table
