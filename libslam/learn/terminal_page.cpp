#include "libslam/learn/terminal_page.h"

#include <algorithm>
#include <cctype>
#include <sstream>
#include <vector>

#include "libslam/files/ini.h"
#include "libslam/files/word_list.h"
#include "libslam/files/word_wrap.h"

namespace slam::learn {
namespace {

bool startsWith(const std::string& text, const std::string& begin) {
  return text.compare(0, begin.size(), begin) == 0;
}

void removeAll(std::string& text, const std::string& mark) {
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at))
    text.erase(at, mark.size());
}

/// [words](target) and ![words](target) as words, and the other marks of a line away.
std::string plain(std::string text, const std::string& folder) {
  for (std::size_t open = text.find('['); open != std::string::npos; open = text.find('[', open + 1)) {
    const auto middle = text.find("](", open),
               close = text.find(')', middle == std::string::npos ? 0 : middle);
    if (middle == std::string::npos || close == std::string::npos) continue;
    std::string words = text.substr(open + 1, middle - open - 1);
    const bool is_picture = open > 0 && text[open - 1] == '!';
    if (is_picture) {
      words = "(picture: ";
      words += text.substr(open + 1, middle - open - 1);
      words += ": " + folder + "/" + text.substr(middle + 2, close - middle - 2) + ")";
    }
    const std::size_t begin = is_picture ? open - 1 : open;
    text.replace(begin, close + 1 - begin, words);
    open = begin + words.size() - 1;
  }
  removeAll(text, "*");
  removeAll(text, "`");
  return text;
}

/// "- " or "12. " at the beginning, "" without.
std::string bulletOf(const std::string& line) {
  if (startsWith(line, "- ")) return "- ";
  std::size_t digits = 0;
  while (digits < line.size() && std::isdigit(static_cast<unsigned char>(line[digits])) != 0) ++digits;
  return digits > 0 && line.compare(digits, 2, ". ") == 0 ? line.substr(0, digits + 2) : "";
}

std::vector<std::string> cellsOf(const std::string& line) {
  return files::splitAt(line.substr(1), '|');
}

bool isRule(const std::string& line) {
  return line.find_first_not_of("|-: ") == std::string::npos;
}

class Page {
 public:
  Page(const std::string& folder, std::size_t columns)
      : folder_(folder), columns_(std::max<std::size_t>(columns, 40)) {}

  void add(const std::string& line) {
    if (startsWith(line, "```")) {
      flush();
      in_code_ = !in_code_;
      if (!in_code_) text_ += "\n";
    } else if (in_code_) {
      text_ += line.empty() ? "\n" : "    " + line + "\n";
    } else if (startsWith(line, "<!--") || files::trimmed(line).empty()) {
      flush();
    } else if (startsWith(line, "#")) {
      flush();
      heading(line);
    } else if (startsWith(line, "|")) {
      if (table_.empty()) flush();
      if (!isRule(line)) table_.push_back(cellsOf(plain(line, folder_)));
    } else if (startsWith(line, "![")) {
      flush();
      paragraph_ = line;
      flush(false);
    } else if (!bulletOf(line).empty()) {
      flush(false);
      bullet_ = bulletOf(line);
      paragraph_ = files::trimmed(line.substr(bullet_.size()));
    } else {
      paragraph_ += (paragraph_.empty() ? "" : " ") + files::trimmed(line);
    }
  }

  std::string finish() {
    flush();
    while (text_.size() > 1 && text_[text_.size() - 2] == '\n') text_.pop_back();
    return text_;
  }

 private:
  void heading(const std::string& line) {
    const auto level = line.find_first_not_of('#');
    const std::string title = plain(files::trimmed(line.substr(level)), folder_);
    text_ += title + "\n" + std::string(files::letters(title), level == 1 ? '=' : '-') + "\n\n";
  }

  /// ends: with an empty line behind.
  void flush(bool ends = true) {
    if (!paragraph_.empty()) {
      text_ += wrappedText(plain(paragraph_, folder_), columns_, bullet_,
                           std::string(files::letters(bullet_), ' '));
      if (ends || bullet_.empty()) text_ += "\n";
    }
    paragraph_.clear();
    bullet_.clear();
    if (!table_.empty()) writeTable();
    table_.clear();
  }

  void writeTable() {
    std::vector<std::size_t> widths(table_.front().size(), 0);
    for (const auto& row : table_)
      for (std::size_t c = 0; c < std::min(row.size(), widths.size()); ++c)
        widths[c] = std::max(widths[c], files::letters(row[c]));
    std::size_t before = 0;  // all columns but the last, which may be broken
    for (std::size_t c = 0; c + 1 < widths.size(); ++c) before += widths[c] + 2;
    const bool fits = before + 24 <= columns_;
    for (std::size_t r = 0; r < table_.size(); ++r) {
      std::string first;
      for (std::size_t c = 0; c + 1 < table_[r].size(); ++c)
        first +=
            table_[r][c] + (fits ? std::string(widths[c] + 2 - files::letters(table_[r][c]), ' ') : ": ");
      text_ += wrappedText(table_[r].back(), columns_, first, std::string(fits ? before : 4, ' '));
      if (r == 0 && fits) text_ += std::string(std::min(before + widths.back(), columns_), '-') + "\n";
    }
    text_ += "\n";
  }

  std::string folder_;
  std::size_t columns_;
  std::string text_, paragraph_, bullet_;
  std::vector<std::vector<std::string>> table_;
  bool in_code_ = false;
};

}  // namespace

std::string wrappedText(const std::string& text, std::size_t columns, const std::string& first,
                        const std::string& indent) {
  std::string result;
  for (const auto& line : files::wrapped(text, columns, first, indent)) result += line + "\n";
  return result;
}

std::string terminalPage(const std::string& markdown, const std::string& folder, std::size_t columns) {
  Page page(folder, columns);
  std::istringstream lines(markdown);
  for (std::string line; std::getline(lines, line);) page.add(line);
  return page.finish();
}

}  // namespace slam::learn
