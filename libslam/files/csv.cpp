#include "libslam/files/csv.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "libslam/core/error.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"

namespace slam::files {
namespace {

std::string placeOf(const std::string& path, int line) {
  return path + ":" + std::to_string(line);
}

}  // namespace

bool CsvReader::next(std::vector<std::string>& fields) {
  if (at_ >= text_.size()) return false;
  begin_ = at_;
  line_ = next_line_;
  std::size_t count = 0;
  do {
    if (count == fields.size()) fields.emplace_back();
    std::string& field = fields[count++];
    field.clear();
    if (at_ < text_.size() && text_[at_] == '"') readQuoted(field);
    readPlain(field);
    end_ = at_;
  } while (passSeparator());
  fields.resize(count);
  return true;
}

std::string CsvReader::place() const {
  return placeOf(path_, line_);
}

void CsvReader::readQuoted(std::string& field) {
  const int begun = next_line_;
  while (true) {
    const auto quote = text_.find('"', at_ + 1);
    if (quote == std::string_view::npos)
      throw core::InputError(placeOf(path_, begun) + ": a quoted field has no end, expected '\"'");
    const auto inside = text_.substr(at_ + 1, quote - at_ - 1);
    next_line_ += static_cast<int>(std::count(inside.begin(), inside.end(), '\n'));
    field += inside;
    at_ = quote + 1;
    if (at_ >= text_.size() || text_[at_] != '"') return;
    field += '"';
  }
}

void CsvReader::readPlain(std::string& field) {
  auto end = at_;  // by hand: twice as fast as find_first_of()
  while (end < text_.size() && text_[end] != ',' && text_[end] != '\n') ++end;
  if (end > at_ && end < text_.size() && text_[end] == '\n' && text_[end - 1] == '\r') --end;
  if (end == text_.size() && end > at_ && text_[end - 1] == '\r') --end;
  field += text_.substr(at_, end - at_);
  at_ = end;
}

bool CsvReader::passSeparator() {
  if (at_ < text_.size() && text_[at_] == '\r') ++at_;
  if (at_ >= text_.size()) return false;
  const bool is_comma = text_[at_++] == ',';
  if (!is_comma) ++next_line_;
  return is_comma;
}

double csvNumber(const std::string& field, const std::string& place) {
  double value = 0;
  if (!parseNumber(field, value))
    throw core::InputError(place + ": found '" + field + "', expected a number");
  return value;
}

CsvTable::CsvTable(std::string_view text, std::string path) : path_(std::move(path)) {
  CsvReader reader(text, path_);
  if (!reader.next(names_)) throw core::InputError(path_ + ": is empty, expected a header and rows");
  for (std::size_t i = 0; i < names_.size(); ++i) columns_.emplace(names_[i], i);
  for (std::vector<std::string> fields; reader.next(fields);) {
    if (reader.record().empty()) continue;
    if (fields.size() != names_.size())
      throw core::InputError(reader.place() + ": found " + std::to_string(fields.size()) +
                             " fields, expected " + std::to_string(names_.size()) + " as in the header");
    rows_.push_back(std::move(fields));
    lines_.push_back(reader.line());
  }
}

CsvTable CsvTable::read(const std::string& path) {
  return {readTextFile(path), path};
}

std::vector<std::string> CsvTable::texts(const std::string& name) const {
  const auto column = columnOf(name);
  std::vector<std::string> fields;
  fields.reserve(rows_.size());
  for (const auto& row : rows_) fields.push_back(row[column]);
  return fields;
}

std::size_t CsvTable::columnOf(const std::string& name) const {
  const auto column = columns_.find(name);
  if (column == columns_.end())
    throw core::InputError(path_ + ":1: names no column '" + name + "'" + core::didYouMean(name, names_));
  return column->second;
}

std::vector<double> CsvTable::numbers(const std::string& name, bool may_lack) const {
  const auto column = columnOf(name);
  std::vector<double> values;
  values.reserve(rows_.size());
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const auto& field = rows_[i][column];
    values.push_back(may_lack && field.empty() ? std::numeric_limits<double>::quiet_NaN()
                                               : csvNumber(field, placeOf(path_, lines_[i]) + ": " + name));
  }
  return values;
}

}  // namespace slam::files
