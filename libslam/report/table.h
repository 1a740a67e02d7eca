#pragma once
#include <string>
#include <variant>
#include <vector>

namespace slam::report {

/// A cell: text, or a number with the column's digits. NaN is printed as "-" and as null in JSON.
using CellValue = std::variant<std::string, double>;

struct Column {
  std::string key;    ///< machine name with unit, for CSV and JSON: "ate_rmse_m"
  std::string title;  ///< for people: "ATE rmse (m)"
  int decimals = 3;   ///< of numbers; text formats only, CSV and JSON keep full precision
};

struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<CellValue>> rows;  ///< each as long as columns (ContractError otherwise)
  std::vector<std::string> notes;            ///< lines under the table
};

/// Aligned columns, at most 80 wide where it can be; UTF-8.
std::string toText(const Table& table);
std::string toMarkdown(const Table& table);
std::string toCsv(const Table& table);   ///< RFC 4180
std::string toJson(const Table& table);  ///< {"caption", "columns", "rows": [{key: value}], "notes"}

}  // namespace slam::report
