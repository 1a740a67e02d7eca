#include "libslam/report/page_table.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libslam/core/numbers.h"
#include "libslam/draw/page_text.h"
#include "libslam/files/parameters.h"
#include "libslam/report/html_report.h"

namespace slam::report {
namespace {

using core::kNaN;

/// What sorts: the number itself, not its rounded text; of "0.5 [0.4, 0.6]" the first, of "<0.001" less than
/// that.
std::string sortValue(const table::CellValue& cell) {
  double number = kNaN;
  if (const auto* value = std::get_if<double>(&cell)) {
    number = *value;
  } else {
    const auto& text = std::get<std::string>(cell);
    const bool is_bound = !text.empty() && text.front() == '<';
    if (text != "-" && !files::parseNumber(text.substr(is_bound ? 1 : 0, text.find(" [")), number)) return "";
    if (is_bound) number /= 2;
  }
  if (std::isfinite(number)) return nlohmann::json(number).dump();
  return std::isnan(number) ? "NaN" : number > 0 ? "Infinity" : "-Infinity";
}

std::string cellElement(const table::CellValue& cell, const table::Column& column, bool is_head) {
  const auto text = draw::htmlText(table::shownText(cell, column));
  if (is_head) return "<th scope=\"row\">" + text + "</th>";
  const auto value = sortValue(cell);
  if (value.empty()) return "<td>" + text + "</td>";
  return "<td class=\"number\" data-value=\"" + value + "\">" + text + "</td>";
}

/// "" where none is known.
std::string meaningOf(const table::Column& column, const Meanings& meanings) {
  for (const auto& name : {column.key, column.title})
    if (const auto it = meanings.find(name); it != meanings.end()) return it->second;
  return "";
}

}  // namespace

std::string meaningsElement(const std::string& id, const std::string& heading,
                            const std::vector<std::pair<std::string, std::string>>& meanings, bool is_open) {
  if (meanings.empty()) return "";
  std::string html = "<details class=\"meanings\"" + (id.empty() ? "" : " id=\"" + id + "\"") +
                     (is_open ? " open" : "") + "><summary>" + draw::htmlText(heading) + "</summary>\n<dl>";
  for (const auto& [name, meaning] : meanings)
    html += "<dt>" + draw::htmlText(name) + "</dt><dd>" + draw::htmlText(meaning) + "</dd>\n";
  return html + "</dl></details>\n";
}

std::string tableElement(const table::Table& table, const Meanings& meanings) {
  std::string html = "<section class=\"wide\" tabindex=\"0\" aria-label=\"" + draw::htmlText(table.caption) +
                     "\">\n<table class=\"sortable\">\n" + "<caption><span>" + draw::htmlText(table.caption) +
                     "</span></caption>" + "\n<thead><tr>";
  std::vector<std::pair<std::string, std::string>> shown;
  for (size_t i = 0; i < table.columns.size(); ++i) {
    const bool numeric = std::any_of(table.rows.begin(), table.rows.end(),
                                     [i](const auto& row) { return !sortValue(row[i]).empty(); });
    const auto& column = table.columns[i];
    const auto meaning = meaningOf(column, meanings);
    html += std::string("<th scope=\"col\"") + (numeric ? " class=\"number\"" : "") +
            (meaning.empty() ? "" : " title=\"" + draw::htmlText(meaning) + "\"") + ">" +
            draw::htmlText(column.title) + "</th>";
    if (!meaning.empty()) shown.emplace_back(column.title, meaning);
  }
  html += "</tr></thead>\n<tbody>\n";
  const size_t rows = std::min(table.rows.size(), kMostTableRows);
  for (size_t r = 0; r < rows; ++r) {
    const auto& row = table.rows[r];
    html += "<tr>";
    for (size_t i = 0; i < row.size(); ++i) html += cellElement(row[i], table.columns[i], i == 0);
    html += "</tr>\n";
  }
  html += "</tbody></table></section>\n";
  if (rows < table.rows.size())
    html += "<p class=\"note\">The first " + std::to_string(rows) + " of " +
            std::to_string(table.rows.size()) + " rows.</p>\n";
  for (const auto& note : table.notes) html += "<p class=\"note\">" + draw::htmlText(note) + "</p>\n";
  return html + meaningsElement("", "What the columns mean", shown, false);
}

}  // namespace slam::report
