#include "libslam/table/cells.h"

#include <cmath>
#include <vector>

#include "libslam/core/error.h"
#include "libslam/files/parameters.h"

namespace slam::table {

std::size_t columnOf(const Table& table, const std::string& key, const std::string& path) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].key == key) return i;
    keys.push_back(table.columns[i].key);
  }
  throw core::InputError(path + ":1: names no column '" + key + "'" + core::didYouMean(key, keys));
}

std::string textOf(const CellValue& cell) {
  if (const auto* number = std::get_if<double>(&cell))
    return std::isnan(*number) ? "" : files::formatNumber(*number);
  return std::get<std::string>(cell);
}

double numberOf(const CellValue& cell) {
  const auto* number = std::get_if<double>(&cell);
  return number == nullptr ? std::nan("") : *number;
}

}  // namespace slam::table
