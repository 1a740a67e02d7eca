#include <cmath>

#include "libslam/core/error.h"
#include "libslam/core/parameters.h"
#include "libslam/report/table.h"

namespace slam::report {
namespace {

/// Record after record of an RFC 4180 file.
class CsvReader {
 public:
  CsvReader(const std::string& text, const std::string& path) : text_(text), path_(path) {}

  bool atEnd() const { return at_ >= text_.size(); }
  int line() const { return line_; }  ///< on which the next record begins

  std::vector<std::string> next() {
    std::vector<std::string> fields(1);
    while (!atEnd()) {
      const char c = text_[at_++];
      if (c == '"') {
        readQuoted(fields.back());
      } else if (c == ',') {
        fields.emplace_back();
      } else if (c == '\n') {
        ++line_;
        break;
      } else if (c != '\r' || (at_ < text_.size() && text_[at_] != '\n')) {
        fields.back() += c;
      }
    }
    return fields;
  }

 private:
  void readQuoted(std::string& field) {
    const int begun = line_;
    while (true) {
      if (atEnd())
        throw core::InputError(path_ + ":" + std::to_string(begun) +
                               ": a quoted field has no end, expected '\"'");
      const char c = text_[at_++];
      if (c == '\n') ++line_;
      if (c != '"') {
        field += c;
      } else if (!atEnd() && text_[at_] == '"') {
        field += text_[at_++];
      } else {
        return;
      }
    }
  }

  const std::string& text_;
  const std::string& path_;
  std::size_t at_ = 0;
  int line_ = 1;
};

CellValue cellOf(const std::string& field) {
  double number = 0;
  if (field.empty()) return std::nan("");
  if (core::parseNumber(field, number)) return number;
  if (field == "inf" || field == "-inf") return field.front() == '-' ? -INFINITY : INFINITY;
  return field;
}

}  // namespace

Table fromCsv(const std::string& csv, const std::string& path) {
  CsvReader reader(csv, path);
  if (reader.atEnd()) throw core::InputError(path + ": is empty, expected a header and rows");
  Table table;
  for (const auto& key : reader.next()) table.columns.push_back({key, key});
  while (!reader.atEnd()) {
    const int line = reader.line();
    const auto fields = reader.next();
    if (fields.size() == 1 && fields.front().empty()) continue;
    if (fields.size() != table.columns.size())
      throw core::InputError(path + ":" + std::to_string(line) + ": found " + std::to_string(fields.size()) +
                             " fields, expected " + std::to_string(table.columns.size()) +
                             " as in the header");
    table.rows.emplace_back();
    for (const auto& field : fields) table.rows.back().push_back(cellOf(field));
  }
  return table;
}

}  // namespace slam::report
