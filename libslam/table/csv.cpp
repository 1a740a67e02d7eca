#include <cmath>

#include "libslam/files/csv.h"
#include "libslam/files/parameters.h"
#include "libslam/table/table.h"

namespace slam::table {
namespace {

CellValue cellOf(const std::string& field) {
  double number = 0;
  if (field.empty()) return std::nan("");
  if (files::parseNumber(field, number)) return number;
  if (field == "inf" || field == "-inf") return field.front() == '-' ? -INFINITY : INFINITY;
  return field;
}

}  // namespace

Table fromCsv(const std::string& csv, const std::string& path) {
  const files::CsvTable read(csv, path);
  Table table;
  for (const auto& key : read.names()) table.columns.push_back({key, key});
  for (const auto& fields : read.rows()) {
    table.rows.emplace_back();
    for (const auto& field : fields) table.rows.back().push_back(cellOf(field));
  }
  return table;
}

}  // namespace slam::table
