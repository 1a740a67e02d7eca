#include "libslam/table/table.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/fixed_number.h"
#include "libslam/files/parameters.h"
#include "libslam/table/number_text.h"
#include "libslam/table/parts.h"

namespace slam::table {

void checkTable(const Table& table) {
  std::set<std::string> keys;
  for (const auto& column : table.columns)
    if (!keys.insert(column.key).second)
      throw core::ContractError("table '" + table.caption + "': two columns have the key '" + column.key +
                                "'");
  for (size_t row = 0; row < table.rows.size(); ++row)
    if (table.rows[row].size() != table.columns.size())
      throw core::ContractError("table '" + table.caption + "': row " + std::to_string(row) + " has " +
                                std::to_string(table.rows[row].size()) + " cells, expected " +
                                std::to_string(table.columns.size()));
}

std::string onOneLine(std::string text) {
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ') c = ' ';
  return text;
}

bool isNumeric(const Table& table, size_t column) {
  return std::any_of(table.rows.begin(), table.rows.end(),
                     [column](const auto& row) { return std::holds_alternative<double>(row[column]); });
}

std::string fixedText(double value, int decimals) {
  if (std::isnan(value)) return "-";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  std::string text;
  core::appendFixed(text, value, std::clamp(decimals, 0, 60));  // "-0.000" would ask the reader what it means
  return text;
}

std::string shownNumber(double number, const Column& column) {
  const auto text = fixedText(std::abs(number), column.decimals);
  const bool is_bound = column.shows_bound && number > 0 && text.find_first_not_of("0.") == std::string::npos;
  return is_bound ? "<" + fixedText(core::powerOfTen(-column.decimals), column.decimals) : text;
}

namespace {

std::string markdownCell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string csvCell(const CellValue& cell) {
  if (const auto* text = std::get_if<std::string>(&cell)) return csvField(*text);
  const double number = std::get<double>(cell);
  if (std::isfinite(number)) return files::formatNumber(number);
  return std::isnan(number) ? "" : number > 0 ? "inf" : "-inf";
}

}  // namespace

std::string shownText(const CellValue& cell, const Column& column) {
  if (const auto* number = std::get_if<double>(&cell))
    return *number > 0 ? shownNumber(*number, column) : fixedText(*number, column.decimals);
  return onOneLine(std::get<std::string>(cell));
}

std::string fixed(double value, int decimals) {
  return shownText(value, {"", "", decimals});
}

std::string toMarkdown(const Table& table) {
  checkTable(table);
  std::string text;
  if (!table.caption.empty()) text += "**" + onOneLine(table.caption) + "**\n\n";
  text += "|";
  for (const auto& column : table.columns) text += " " + markdownCell(onOneLine(column.title)) + " |";
  text += "\n|";
  for (size_t i = 0; i < table.columns.size(); ++i) text += isNumeric(table, i) ? " ---: |" : " --- |";
  text += "\n";
  for (const auto& row : table.rows) {
    text += "|";
    for (size_t i = 0; i < row.size(); ++i)
      text += " " + markdownCell(shownText(row[i], table.columns[i])) + " |";
    text += "\n";
  }
  for (const auto& note : table.notes) text += "\n" + onOneLine(note) + "\n";
  return text;
}

namespace {

/// The cells of a line that begins and ends with a bar.
std::vector<std::string> markdownCells(const std::string& line) {
  std::vector<std::string> cells(1);
  for (size_t i = 1; i + 1 < line.size(); ++i) {
    if (line[i] == '|')
      cells.emplace_back();
    else if (line[i] != '\\' || line[i + 1] != '|')
      cells.back() += line[i];
    else
      cells.back() += line[++i];
  }
  for (auto& cell : cells)  // a blank on either side
    cell = cell.size() > 2 ? cell.substr(1, cell.size() - 2) : "";
  return cells;
}

}  // namespace

Table fromMarkdown(const std::string& markdown) {
  Table table;
  std::istringstream lines(markdown);
  bool is_rule_next = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.empty()) continue;
    if (line.front() != '|') {
      const bool bold = line.size() > 4 && line.substr(0, 2) == "**" && line.substr(line.size() - 2) == "**";
      if (bold && table.columns.empty())
        table.caption = line.substr(2, line.size() - 4);
      else
        table.notes.push_back(line);
    } else if (table.columns.empty()) {
      for (const auto& title : markdownCells(line)) table.columns.push_back({title, title});
      is_rule_next = true;
    } else if (is_rule_next) {
      is_rule_next = false;
    } else {
      const auto cells = markdownCells(line);
      table.rows.emplace_back(cells.begin(), cells.end());
      table.rows.back().resize(table.columns.size(), std::string());
    }
  }
  return table;
}

std::string toCsv(const Table& table) {
  checkTable(table);
  std::string text;
  const auto endField = [&](size_t i) { text += i + 1 < table.columns.size() ? "," : "\r\n"; };
  for (size_t i = 0; i < table.columns.size(); ++i) text += csvField(table.columns[i].key), endField(i);
  for (const auto& row : table.rows)
    for (size_t i = 0; i < row.size(); ++i) text += csvCell(row[i]), endField(i);
  return text;
}

std::string toJson(const Table& table) {
  checkTable(table);
  nlohmann::ordered_json json;
  json["caption"] = table.caption;
  json["columns"] = nlohmann::ordered_json::array();
  for (const auto& column : table.columns)
    json["columns"].push_back({{"key", column.key}, {"title", column.title}});
  json["rows"] = nlohmann::ordered_json::array();
  for (const auto& row : table.rows) {
    auto object = nlohmann::ordered_json::object();
    for (size_t i = 0; i < row.size(); ++i)
      std::visit([&](const auto& value) { object[table.columns[i].key] = value; }, row[i]);
    json["rows"].push_back(std::move(object));
  }
  json["notes"] = table.notes;
  // The library writes numbers that are not finite as null. A file name need not be valid UTF-8.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace slam::table
