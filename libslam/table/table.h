#pragma once
#include <string>
#include <variant>
#include <vector>

namespace slam::table {

/// A cell: text, or a number with the column's digits. NaN is "-" for people, null in JSON and an empty field
/// in CSV; infinity is "inf", in JSON null.
using CellValue = std::variant<std::string, double>;

struct Column {
  std::string key;    ///< machine name with unit, for CSV and JSON: "ate_rmse_m"
  std::string title;  ///< for people: "ATE rmse (m)"
  int decimals = 3;   ///< of numbers; text formats only, CSV and JSON keep full precision
  /// For p-values: a positive number that rounds to 0 is shown as "<0.001".
  bool shows_bound = false;
};

struct Table {
  std::string caption;
  std::vector<Column> columns;
  std::vector<std::vector<CellValue>> rows;  ///< each as long as columns (ContractError otherwise)
  std::vector<std::string> notes;            ///< lines under the table
};

/// What people read of a cell: text on one line, numbers with the column's digits.
std::string shownText(const CellValue& cell, const Column& column);

// All five: the same table gives the same bytes. Columns that hold a number are aligned right. Line breaks
// inside a text become blanks, except in CSV and JSON. Two columns with one key, or a row that is not as long
// as `columns`: ContractError.

/// Aligned columns (letters counted as UTF-8 code points). Where that is wider than 80, titles are broken
/// over lines at blanks; caption and notes always.
std::string toText(const Table& table);
/// Caption in bold, a GitHub-flavoured table, notes as paragraphs.
std::string toMarkdown(const Table& table);
/// What toMarkdown() wrote, read back as people saw it: columns whose key is their title, cells that are
/// text, with "-" and the digits shown. No rows where there is no table.
Table fromMarkdown(const std::string& markdown);
/// A table float with booktabs' rules (needs the package booktabs; UTF-8): caption, tabular, notes in small
/// print below. What LaTeX would read as a command is escaped; "--" is NaN, a minus sign and infinity are set
/// as mathematics.
std::string toLatex(const Table& table);
/// RFC 4180: header of keys, lines end with CR LF; numbers with the digits that read back the same. No
/// caption, no notes.
std::string toCsv(const Table& table);
/// What toCsv() wrote, or any RFC 4180 file with a header (lines may end with LF alone): columns whose title
/// is their key; what reads as a number is one, an empty field NaN. Errors: InputError with path and line: no
/// header, a row of another length, a quote that does not end.
Table fromCsv(const std::string& csv, const std::string& path);
/// {"caption": text, "columns": [{"key", "title"}], "rows": [{key: value}], "notes": [text]}
std::string toJson(const Table& table);

}  // namespace slam::table
