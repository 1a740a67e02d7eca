#include "libslam/run/journal_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "libslam/core/csv.h"
#include "libslam/core/error.h"
#include "libslam/core/files.h"
#include "libslam/core/parameters.h"

namespace slam::run {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

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
  const auto csv = core::CsvTable::read(path);
  for (const char* needed :
       {"scan", "time_s", "event", "value", "other_scan", "x_m", "y_m", "other_x_m", "other_y_m", "detail"})
    if (!csv.has(needed))
      throw core::InputError(path + ":1: the column '" + needed +
                             "' is missing, expected a journal of 'rasterslam run'");
  const auto scan = csv.numbers("scan"), time_s = csv.numbers("time_s"), value = csv.numbers("value"),
             other_scan = csv.numbersOrNan("other_scan"), x = csv.numbers("x_m"), y = csv.numbers("y_m"),
             other_x = csv.numbersOrNan("other_x_m"), other_y = csv.numbersOrNan("other_y_m");
  const auto event = csv.texts("event"), detail = csv.texts("detail");
  std::vector<JournalLine> journal;
  for (size_t i = 0; i < scan.size(); ++i)
    journal.push_back({static_cast<int>(scan[i]),
                       time_s[i],
                       event[i],
                       value[i],
                       std::isnan(other_scan[i]) ? -1 : static_cast<int>(other_scan[i]),
                       {x[i], y[i]},
                       {other_x[i], other_y[i]},
                       detail[i]});
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
