#include "libslam/table/text.h"

#include <algorithm>

#include "libslam/files/word_wrap.h"
#include "libslam/table/parts.h"

namespace slam::table {
std::vector<std::string> wrapped(const std::string& text, size_t limit) {
  return files::words(text).empty() ? std::vector<std::string>() : files::wrapped(text, limit);
}

size_t longest(const std::vector<std::string>& lines) {
  size_t most = 0;
  for (const auto& line : lines) most = std::max(most, files::letters(line));
  return most;
}

namespace {

constexpr size_t kTextWidth = 80;
constexpr size_t kGap = 2;
constexpr size_t kLongText = 28;  // letters of a cell that may be broken over lines

std::string padded(const std::string& text, size_t to_width, bool right) {
  const std::string blanks(to_width - std::min(to_width, files::letters(text)), ' ');
  return right ? blanks + text : text + blanks;
}

/// A column laid out for a fixed pitch.
struct TextColumn {
  bool right = false;
  size_t width = 0;
  std::vector<std::string> title;               ///< lines
  std::vector<std::vector<std::string>> cells;  ///< lines of each
};
using Columns = std::vector<const TextColumn*>;

size_t totalWidth(const Columns& columns) {
  size_t total = columns.empty() ? 0 : kGap * (columns.size() - 1);
  for (const auto* column : columns) total += column->width;
  return total;
}

TextColumn layOut(const Table& table, size_t index, bool break_titles, bool break_cells) {
  TextColumn column;
  column.right = isNumeric(table, index);
  for (const auto& row : table.rows) {
    const auto text = shownText(row[index], table.columns[index]);
    const bool breaks = break_cells && !column.right && files::letters(text) > kLongText;
    column.cells.push_back(breaks ? wrapped(text, kLongText) : std::vector<std::string>{text});
    column.width = std::max(column.width, longest(column.cells.back()));
  }
  const auto title = onOneLine(table.columns[index].title);
  column.width = std::max(column.width, break_titles ? longest(files::words(title)) : files::letters(title));
  column.title = wrapped(title, column.width);
  return column;
}

std::vector<TextColumn> layOutAll(const Table& table, bool break_titles, bool break_cells) {
  std::vector<TextColumn> columns;
  for (size_t i = 0; i < table.columns.size(); ++i)
    columns.push_back(layOut(table, i, break_titles, break_cells));
  return columns;
}

Columns all(const std::vector<TextColumn>& columns) {
  Columns pointers;
  for (const auto& column : columns) pointers.push_back(&column);
  return pointers;
}

void appendLine(std::string& text, const Columns& columns, const std::vector<std::string>& cells) {
  std::string line;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (i > 0) line.append(kGap, ' ');
    line += padded(cells[i], columns[i]->width, columns[i]->right);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  text += line + "\n";
}

void appendTitles(std::string& text, const Columns& columns) {
  size_t height = 0;
  for (const auto* column : columns) height = std::max(height, column->title.size());
  for (size_t line = 0; line < height; ++line) {
    std::vector<std::string> cells;
    for (const auto* column : columns) {  // the last lines stand level
      const size_t above = height - column->title.size();
      cells.push_back(line < above ? "" : column->title[line - above]);
    }
    appendLine(text, columns, cells);
  }
  std::vector<std::string> rule;
  for (const auto* column : columns) rule.emplace_back(column->width, '-');
  appendLine(text, columns, rule);
}

void appendRows(std::string& text, const Columns& columns, size_t rows) {
  for (size_t row = 0; row < rows; ++row) {
    size_t height = 1;
    for (const auto* column : columns) height = std::max(height, column->cells[row].size());
    for (size_t line = 0; line < height; ++line) {
      std::vector<std::string> cells;
      for (const auto* column : columns)
        cells.push_back(line < column->cells[row].size() ? column->cells[row][line] : "");
      appendLine(text, columns, cells);
    }
  }
}

/// Columns that name a row: the leading ones with text, as long as half of the width is left for others; at
/// least one.
size_t keyCount(const std::vector<TextColumn>& columns, size_t width) {
  size_t keys = 0, used = 0;
  while (keys < columns.size() && !columns[keys].right && used + columns[keys].width <= width / 2)
    used += columns[keys++].width + kGap;
  return std::max<size_t>(keys, 1);
}

/// Blocks that fit, each with the keys on its left.
std::vector<Columns> blocksOf(const std::vector<TextColumn>& columns, size_t width) {
  const Columns whole = all(columns);
  if (totalWidth(whole) <= width || columns.size() < 2) return {whole};
  const auto keys = static_cast<std::ptrdiff_t>(keyCount(columns, width));
  const Columns names(whole.begin(), whole.begin() + keys);
  std::vector<Columns> blocks;
  for (auto column = whole.begin() + keys; column != whole.end(); ++column) {
    const bool is_full = blocks.empty() || totalWidth(blocks.back()) + kGap + (*column)->width > width;
    if (is_full) blocks.push_back(names);
    blocks.back().push_back(*column);
  }
  if (blocks.empty()) blocks.push_back(names);
  return blocks;
}

}  // namespace

std::string toTextWithin(const Table& table, size_t width) {
  checkTable(table);
  auto columns = layOutAll(table, false, false);
  if (totalWidth(all(columns)) > width) columns = layOutAll(table, true, false);
  if (totalWidth(all(columns)) > width) columns = layOutAll(table, true, true);
  const size_t prose = std::min(width, kTextWidth);
  std::string text;
  for (const auto& line : wrapped(onOneLine(table.caption), prose)) text += line + "\n";
  if (!text.empty()) text += "\n";
  bool is_first = true;
  for (const auto& block : blocksOf(columns, width)) {
    if (!is_first) text += "\n";
    is_first = false;
    appendTitles(text, block);
    appendRows(text, block, table.rows.size());
  }
  if (!table.notes.empty()) text += "\n";
  for (const auto& note : table.notes)
    for (const auto& line : wrapped(onOneLine(note), prose)) text += line + "\n";
  return text;
}

std::string toText(const Table& table) {
  return toTextWithin(table, kTextWidth);
}

}  // namespace slam::table
