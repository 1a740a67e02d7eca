#include "libslam/results/lost_time.h"

#include <algorithm>
#include <iterator>

namespace slam::results {

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
