#include "libslam/run/journal_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <sstream>

#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"

namespace slam::run {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<std::string> fieldsOf(const std::string& line) {
  std::vector<std::string> fields;
  std::istringstream stream(line);
  for (std::string field; std::getline(stream, field, ',');) fields.push_back(field);
  if (!line.empty() && line.back() == ',') fields.emplace_back();
  return fields;
}

/// One line of the file by the names of its columns.
class Row {
 public:
  Row(const std::map<std::string, size_t>& columns, std::vector<std::string> fields, std::string place)
      : columns_(columns), fields_(std::move(fields)), place_(std::move(place)) {
    if (fields_.size() < columns_.size())
      throw core::InputError(place_ + ": found " + std::to_string(fields_.size()) + " fields, expected " +
                             std::to_string(columns_.size()));
  }
  const std::string& text(const std::string& column) const { return fields_[columns_.at(column)]; }
  double number(const std::string& column) const {
    double value = kNan;
    if (!core::parseNumber(text(column), value))
      throw core::InputError(place_ + ": " + column + ": found '" + text(column) + "', expected a number");
    return value;
  }
  double numberOrNan(const std::string& column) const { return text(column).empty() ? kNan : number(column); }

 private:
  const std::map<std::string, size_t>& columns_;
  std::vector<std::string> fields_;
  std::string place_;
};

}  // namespace

std::vector<JournalLine> placedJournal(const std::vector<core::JournalEntry>& journal,
                                       const std::vector<double>& stamps_s, const core::Trajectory& path) {
  std::vector<JournalLine> lines;
  for (const auto& entry : journal) {
    JournalLine line;
    // What happens in the end is the last scan's.
    const auto scan = std::min(static_cast<size_t>(entry.scan), stamps_s.size() - 1);
    line.scan = static_cast<int>(scan);
    line.time_s = stamps_s[scan] - stamps_s.front();
    line.event = entry.event;
    line.value = entry.value;
    line.other_scan = entry.other_scan;
    line.place = core::position(path[scan].pose);
    line.other_place = {kNan, kNan};
    if (entry.other_scan >= 0)
      line.other_place =
          core::position(path[std::min(static_cast<size_t>(entry.other_scan), path.size() - 1)].pose);
    line.detail = entry.detail;
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string journalCsv(const std::vector<JournalLine>& journal) {
  std::string text = "scan,time_s,event,value,other_scan,x_m,y_m,other_x_m,other_y_m,detail\n";
  const auto metres = [](double value) {
    char number[40];
    std::snprintf(number, sizeof number, "%.3f", value);
    return std::string(number);
  };
  for (const auto& line : journal) {
    const bool has_other = line.other_scan >= 0;
    text += std::to_string(line.scan) + ',' + core::formatNumber(line.time_s) + ',' + line.event + ',' +
            core::formatNumber(line.value) + ',' + (has_other ? std::to_string(line.other_scan) : "") + ',' +
            metres(line.place.x) + ',' + metres(line.place.y) + ',' +
            (has_other ? metres(line.other_place.x) + ',' + metres(line.other_place.y) : ",") + ',' +
            line.detail + '\n';
  }
  return text;
}

std::vector<JournalLine> readJournal(const std::string& path) {
  std::istringstream lines(core::readTextFile(path));
  std::string text;
  std::getline(lines, text);
  std::map<std::string, size_t> columns;
  const auto names = fieldsOf(text);
  for (size_t i = 0; i < names.size(); ++i) columns[names[i]] = i;
  for (const char* needed :
       {"scan", "time_s", "event", "value", "other_scan", "x_m", "y_m", "other_x_m", "other_y_m", "detail"})
    if (columns.count(needed) == 0)
      throw core::InputError(path + ":1: the column '" + needed +
                             "' is missing, expected a journal of 'rasterslam run'");
  std::vector<JournalLine> journal;
  for (int number = 2; std::getline(lines, text); ++number) {
    const Row row(columns, fieldsOf(text), path + ":" + std::to_string(number));
    JournalLine line;
    line.scan = static_cast<int>(row.number("scan"));
    line.time_s = row.number("time_s");
    line.event = row.text("event");
    line.value = row.number("value");
    line.other_scan = row.text("other_scan").empty() ? -1 : static_cast<int>(row.number("other_scan"));
    line.place = {row.number("x_m"), row.number("y_m")};
    line.other_place = {row.numberOrNan("other_x_m"), row.numberOrNan("other_y_m")};
    line.detail = row.text("detail");
    journal.push_back(std::move(line));
  }
  return journal;
}

std::string journalText(const std::vector<JournalLine>& journal) {
  size_t widest = std::string("event").size();
  for (const auto& line : journal) widest = std::max(widest, line.event.size());
  const int event_width = static_cast<int>(widest);
  char text[200];
  std::snprintf(text, sizeof text, "%7s %9s  %-*s %10s %8s %8s  %s\n", "scan", "time s", event_width, "event",
                "value", "x m", "y m", "refers to");
  std::string all = text;
  for (const auto& line : journal) {
    std::snprintf(text, sizeof text, "%7d %9.1f  %-*s %10.4g %8.2f %8.2f", line.scan, line.time_s,
                  event_width, line.event.c_str(), line.value, line.place.x, line.place.y);
    all += text;
    if (line.other_scan >= 0) {
      std::snprintf(text, sizeof text, "  scan %d at %.2f, %.2f", line.other_scan, line.other_place.x,
                    line.other_place.y);
      all += text;
    }
    if (!line.detail.empty()) all += "  " + line.detail;
    all += '\n';
  }
  return all;
}

std::optional<JournalLine> lostInTheEnd(const std::vector<JournalLine>& journal) {
  std::optional<JournalLine> lost;
  for (const auto& line : journal) {
    if (line.event == "lost" && !lost) lost = line;
    if (line.event == "recovered" || line.event == "found again") lost.reset();
  }
  return lost;
}

std::string lostText(const JournalLine& lost) {
  char text[80];
  std::snprintf(text, sizeof text, "lost at scan %d (%.1f s)", lost.scan, lost.time_s);
  return text;
}

}  // namespace slam::run
