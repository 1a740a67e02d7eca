#include "libslam/table/latex.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "libslam/files/word_wrap.h"
#include "libslam/table/parts.h"

namespace slam::table {
namespace {

constexpr double kTextWidthPt = 345;  // of article at 10pt
constexpr double kLetterEm = 0.55;    // a bold digit of Computer Modern is 0.575 wide, most letters are less
constexpr std::size_t kLongText = 28;

/// A size of type and the blank beside each cell, from the largest on.
struct Setting {
  const char* command;
  double letter_pt, gap_pt;
};
constexpr std::array<Setting, 4> kSettings = {{{"", 10 * kLetterEm, 6},
                                               {"\\small", 9 * kLetterEm, 4},
                                               {"\\footnotesize", 8 * kLetterEm, 3},
                                               {"\\scriptsize", 7.3 * kLetterEm, 2}}};

std::string latexText(const std::string& text) {
  // Also what only a place makes special: "[" and "*" after a line's end, two hyphens in a row.
  static const std::map<char, std::string> replacements = {{'\\', "\\textbackslash{}"},
                                                           {'{', "\\{"},
                                                           {'}', "\\}"},
                                                           {'$', "\\$"},
                                                           {'&', "\\&"},
                                                           {'%', "\\%"},
                                                           {'#', "\\#"},
                                                           {'_', "\\_"},
                                                           {'~', "\\textasciitilde{}"},
                                                           {'^', "\\textasciicircum{}"},
                                                           {'<', "\\textless{}"},
                                                           {'>', "\\textgreater{}"},
                                                           {'|', "\\textbar{}"},
                                                           {'"', "''"},
                                                           {'[', "{[}"},
                                                           {']', "{]}"},
                                                           {'*', "{*}"}};
  std::string escaped;
  for (const char c : text) {
    const auto replacement = replacements.find(c);
    if (c == '-' && !escaped.empty() && escaped.back() == '-') escaped += "{}";
    escaped += replacement == replacements.end() ? std::string(1, c) : replacement->second;
  }
  return escaped;
}

std::string latexCell(const CellValue& cell, const Column& column) {
  const auto* number = std::get_if<double>(&cell);
  if (number == nullptr) return latexText(shownText(cell, column));
  if (std::isnan(*number)) return "--";
  std::string text = std::isinf(*number) ? "$\\infty$" : latexText(shownNumber(*number, column));
  // A value that rounds to zero has no sign.
  return fixedText(*number, column.decimals).front() == '-' ? "$-$" + text : text;
}

/// "ATE online m" as "ATE online (m)": a unit that ends a title stands in brackets.
std::string withUnit(const std::string& title) {
  static const std::set<std::string> kUnits = {"m",     "s",   "ms",    "deg",     "rad", "MB", "%",
                                               "deg/m", "m/m", "deg/s", "ms/scan", "m/s", "m2"};
  const auto blank = title.rfind(' ');
  if (blank == std::string::npos || kUnits.count(title.substr(blank + 1)) == 0) return title;
  return title.substr(0, blank) + " (" + title.substr(blank + 1) + ")";
}

struct LatexColumn {
  bool is_numeric = false, is_paragraph = false;
  std::size_t width = 0;           ///< letters
  std::vector<std::string> title;  ///< lines, escaped
  std::vector<std::string> cells;  ///< escaped
};
using Columns = std::vector<const LatexColumn*>;

/// Whether a cell of a column is its best: as people read it, so that equal ones are all best; none where all
/// are equal.
std::vector<bool> bestOf(const Table& table, std::size_t index, const LatexOptions& options) {
  const auto& column = table.columns[index];
  std::vector<bool> best(table.rows.size(), false);
  const auto better = options.best.find(column.key);
  if (better == options.best.end()) return best;
  const auto numberOf = [&](std::size_t row) {
    const auto* number = std::get_if<double>(&table.rows[row][index]);
    return number != nullptr && std::isfinite(*number) ? number : nullptr;
  };
  const double* most = nullptr;
  for (std::size_t row = 0; row < best.size(); ++row)
    if (const auto* number = numberOf(row))
      if (most == nullptr || (better->second == Best::kSmallest ? *number < *most : *number > *most))
        most = number;
  if (most == nullptr) return best;
  for (std::size_t row = 0; row < best.size(); ++row)
    best[row] =
        numberOf(row) != nullptr && shownText(table.rows[row][index], column) == shownText(*most, column);
  if (std::count(best.begin(), best.end(), true) == static_cast<std::ptrdiff_t>(best.size()))
    best.assign(best.size(), false);
  return best;
}

LatexColumn layOut(const Table& table, std::size_t index, const LatexOptions& options, bool break_titles) {
  LatexColumn column;
  column.is_numeric = isNumeric(table, index);
  const auto best = bestOf(table, index, options);
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const auto& cell = table.rows[row][index];
    const std::size_t width = files::letters(shownText(cell, table.columns[index]));
    column.is_paragraph = column.is_paragraph || (!column.is_numeric && width > kLongText);
    column.width = std::max(column.width, std::min(width, column.is_numeric ? width : kLongText));
    const auto text = latexCell(cell, table.columns[index]);
    column.cells.push_back(best[row] ? "\\textbf{" + text + "}" : text);
  }
  const auto title = withUnit(onOneLine(table.columns[index].title));
  column.width = std::max(column.width, break_titles ? longest(files::words(title)) : files::letters(title));
  for (const auto& line : wrapped(title, column.width)) column.title.push_back(latexText(line));
  return column;
}

double widthPt(const Columns& columns, const Setting& setting) {
  double total = 0;
  for (const auto* column : columns)
    total += static_cast<double>(column->width) * setting.letter_pt + 2 * setting.gap_pt;
  return total;
}

/// Parts that fit, each with the columns on its left that name the rows: the leading ones with text.
std::vector<Columns> partsOf(const Columns& columns, const Setting& setting) {
  if (widthPt(columns, setting) <= kTextWidthPt) return {columns};
  Columns names;
  for (const auto* column : columns) {
    names.push_back(column);
    const bool leaves_room = widthPt(names, setting) <= kTextWidthPt / 2;
    if (column->is_numeric || (!leaves_room && names.size() > 1)) {
      names.pop_back();
      break;
    }
  }
  std::vector<Columns> parts;
  for (std::size_t i = names.size(); i < columns.size(); ++i) {
    Columns more = parts.empty() ? names : parts.back();
    more.push_back(columns[i]);
    if (parts.empty() || widthPt(more, setting) > kTextWidthPt) {
      parts.push_back(names);
      parts.back().push_back(columns[i]);
    } else {
      parts.back() = more;
    }
  }
  return parts;
}

std::string tabular(const Columns& columns, std::size_t rows, const Setting& setting) {
  std::string text = "\\begin{tabular}{";
  std::size_t height = 0;
  for (const auto* column : columns) {
    height = std::max(height, column->title.size());
    if (column->is_paragraph)
      text += "p{" + fixedText(static_cast<double>(column->width) * setting.letter_pt, 0) + "pt}";
    else
      text += column->is_numeric ? 'r' : 'l';
  }
  text += "}\n\\toprule\n";
  const auto endCell = [&](std::size_t i) { text += i + 1 < columns.size() ? " & " : " \\\\\n"; };
  for (std::size_t line = 0; line < height; ++line)
    for (std::size_t i = 0; i < columns.size(); ++i) {  // the last lines stand level
      const auto& title = columns[i]->title;
      const std::size_t above = height - title.size();
      text += line < above ? "" : title[line - above];
      endCell(i);
    }
  text += "\\midrule\n";
  for (std::size_t row = 0; row < rows; ++row)
    for (std::size_t i = 0; i < columns.size(); ++i) text += columns[i]->cells[row], endCell(i);
  return text + "\\bottomrule\n\\end{tabular}\n";
}

}  // namespace

std::string toLatex(const Table& table) {
  return toLatex(table, {});
}

std::string toLatex(const Table& table, const LatexOptions& options) {
  checkTable(table);
  std::vector<LatexColumn> laid_out;
  Columns columns;
  for (const bool break_titles : {false, true}) {
    laid_out.clear();
    for (std::size_t i = 0; i < table.columns.size(); ++i)
      laid_out.push_back(layOut(table, i, options, break_titles));
    columns.clear();
    for (const auto& column : laid_out) columns.push_back(&column);
    if (widthPt(columns, kSettings.front()) <= kTextWidthPt) break;
  }
  const auto fits = [&](const Setting& setting) { return widthPt(columns, setting) <= kTextWidthPt; };
  const auto fitting = std::find_if(kSettings.begin(), kSettings.end(), fits);
  const Setting& setting = fitting == kSettings.end() ? kSettings[2] : *fitting;

  std::string text = "\\begin{table}\n\\centering\n";
  if (!table.caption.empty()) text += "\\caption{" + latexText(onOneLine(table.caption)) + "}\n";
  if (!options.label.empty()) text += "\\label{" + options.label + "}\n";
  if (setting.command[0] != '\0')
    text +=
        std::string(setting.command) + "\n\\setlength{\\tabcolsep}{" + fixedText(setting.gap_pt, 0) + "pt}\n";
  bool is_first = true;
  for (const auto& part : partsOf(columns, setting)) {
    if (!is_first) text += "\\par\\medskip\n";
    is_first = false;
    text += tabular(part, table.rows.size(), setting);
  }
  for (const auto& note : table.notes)
    text += "\\par\\smallskip\\parbox{\\linewidth}{\\footnotesize " + latexText(onOneLine(note)) + "}\n";
  return text + "\\end{table}\n";
}

}  // namespace slam::table
