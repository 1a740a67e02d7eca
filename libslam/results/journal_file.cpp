#include "libslam/results/journal_file.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "libslam/core/error.h"
#include "libslam/files/csv.h"
#include "libslam/files/files.h"
#include "libslam/files/parameters.h"

namespace slam::results {

std::vector<core::JournalLine> placedJournal(const std::vector<core::JournalEntry>& journal,
                                             const std::vector<double>& stamps_s,
                                             const core::Trajectory& path) {
  std::vector<core::JournalLine> lines;
  for (const auto& entry : journal) {
    core::JournalLine line{entry};
    // What happens in the end is the last scan's.
    const auto scan = std::min(static_cast<size_t>(entry.scan), stamps_s.size() - 1);
    line.scan = static_cast<int>(scan);
    line.time_s = stamps_s[scan] - stamps_s.front();
    line.place = core::position(path[scan].pose);
    if (entry.other_scan >= 0)
      line.other_place =
          core::position(path[std::min(static_cast<size_t>(entry.other_scan), path.size() - 1)].pose);
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string journalCsv(const std::vector<core::JournalLine>& journal) {
  std::string text = "scan,time_s,event,value,other_scan,x_m,y_m,other_x_m,other_y_m,detail\n";
  const auto metres = [](double value) {
    char number[40];
    std::snprintf(number, sizeof number, "%.3f", value);
    return std::string(number);
  };
  for (const auto& line : journal) {
    const bool has_other = line.other_scan >= 0;
    text += std::to_string(line.scan) + ',' + files::formatNumber(line.time_s) + ',' +
            core::wordOf(line.event) + ',' + files::formatNumber(line.value) + ',' +
            (has_other ? std::to_string(line.other_scan) : "") + ',' + metres(line.place.x) + ',' +
            metres(line.place.y) + ',' +
            (has_other ? metres(line.other_place.x) + ',' + metres(line.other_place.y) : ",") + ',' +
            line.detail + '\n';
  }
  return text;
}

std::vector<core::JournalLine> readJournal(const std::string& path) {
  const auto csv = files::CsvTable::read(path);
  for (const char* needed :
       {"scan", "time_s", "event", "value", "other_scan", "x_m", "y_m", "other_x_m", "other_y_m", "detail"})
    if (!csv.has(needed))
      throw core::InputError(path + ":1: the column '" + needed +
                             "' is missing, expected a journal of 'rasterslam run'");
  const auto scan = csv.numbers("scan"), time_s = csv.numbers("time_s"), value = csv.numbers("value"),
             other_scan = csv.numbersOrNan("other_scan"), x = csv.numbers("x_m"), y = csv.numbers("y_m"),
             other_x = csv.numbersOrNan("other_x_m"), other_y = csv.numbersOrNan("other_y_m");
  const auto event = csv.texts("event"), detail = csv.texts("detail");
  std::vector<core::JournalLine> journal(scan.size());
  for (size_t i = 0; i < scan.size(); ++i) {
    auto& line = journal[i];
    const auto known = core::journalEventOf(event[i]);
    if (!known)
      throw core::InputError(path + ":" + std::to_string(csv.line(i)) + ": event: found '" + event[i] +
                             "', expected a word of a journal of 'rasterslam run'");
    line.scan = static_cast<int>(scan[i]);
    line.event = *known;
    line.value = value[i];
    if (!std::isnan(other_scan[i])) line.other_scan = static_cast<int>(other_scan[i]);
    line.detail = detail[i];
    line.time_s = time_s[i];
    line.place = {x[i], y[i]};
    line.other_place = {other_x[i], other_y[i]};
  }
  return journal;
}

std::string journalText(const std::vector<core::JournalLine>& journal) {
  size_t widest = std::string("event").size();
  for (const auto& line : journal) widest = std::max(widest, std::string(core::wordOf(line.event)).size());
  const int event_width = static_cast<int>(widest);
  char text[200];
  std::snprintf(text, sizeof text, "%7s %9s  %-*s %10s %8s %8s  %s\n", "scan", "time s", event_width, "event",
                "value", "x m", "y m", "refers to");
  std::string all = text;
  for (const auto& line : journal) {
    std::snprintf(text, sizeof text, "%7d %9.1f  %-*s %10.4g %8.2f %8.2f", line.scan, line.time_s,
                  event_width, core::wordOf(line.event), line.value, line.place.x, line.place.y);
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

std::optional<core::JournalLine> lostInTheEnd(const std::vector<core::JournalLine>& journal) {
  std::optional<core::JournalLine> lost;
  for (const auto& line : journal) {
    if (line.event == core::JournalEvent::kLost && !lost) lost = line;
    if (line.event == core::JournalEvent::kRecovered) lost.reset();
  }
  return lost;
}

std::string lostText(const core::JournalLine& lost) {
  char text[80];
  std::snprintf(text, sizeof text, "lost at scan %d (%.1f s)", lost.scan, lost.time_s);
  return text;
}

std::vector<LostSpan> lostSpans(const std::vector<core::JournalLine>& journal, double log_seconds) {
  std::vector<LostSpan> spans;
  bool is_lost = false;
  for (const auto& line : journal) {
    if (line.event == core::JournalEvent::kLost && !is_lost) {
      spans.push_back({line.time_s, log_seconds});
      is_lost = true;
    } else if (line.event == core::JournalEvent::kRecovered && is_lost) {
      spans.back().end_s = line.time_s;
      is_lost = false;
    }
  }
  return spans;
}

double lostShare(const std::vector<core::JournalLine>& journal, double log_seconds) {
  double lost_s = 0;
  for (const LostSpan& span : lostSpans(journal, log_seconds)) lost_s += span.end_s - span.begin_s;
  return log_seconds > 0 ? std::clamp(lost_s / log_seconds, 0.0, 1.0) : 0;
}

core::Trajectory whileNotLost(const core::Trajectory& path, const std::vector<LostSpan>& spans) {
  constexpr double kSameStamp_s = 1e-6;  // as the journal's times are rounded
  core::Trajectory found;
  std::copy_if(path.begin(), path.end(), std::back_inserter(found), [&](const core::StampedPose& pose) {
    const double time_s = pose.time_s - path.front().time_s;
    return std::none_of(spans.begin(), spans.end(), [&](const LostSpan& span) {
      const bool to_the_end =
          &span == &spans.back() && span.end_s >= path.back().time_s - path.front().time_s;
      return time_s > span.begin_s - kSameStamp_s && (to_the_end || time_s < span.end_s - kSameStamp_s);
    });
  });
  return found;
}

}  // namespace slam::results
