#pragma once
#include <vector>

#include "libslam/results/journal_file.h"

namespace slam::results {

/// A time that a robot was lost, seconds since the log's first scan.
struct LostSpan {
  double begin_s = 0, end_s = 0;
};

/// From every `lost` to the next `recovered`, or to the log's end. A robot that gets lost
/// once more meanwhile is in the same span.
std::vector<LostSpan> lostSpans(const std::vector<core::JournalLine>& journal, double log_seconds);

/// The poses of a path outside of these spans; stamps are seconds since its first pose.
core::Trajectory whileNotLost(const core::Trajectory& path, const std::vector<LostSpan>& spans);

}  // namespace slam::results
