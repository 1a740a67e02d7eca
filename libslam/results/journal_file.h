#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"

namespace slam::results {

/// stamps_s and path: of every scan, in the log's order; not empty.
std::vector<core::JournalLine> placedJournal(const std::vector<core::JournalEntry>& journal,
                                             const std::vector<double>& stamps_s,
                                             const core::Trajectory& path);

std::string journalCsv(const std::vector<core::JournalLine>& journal);
/// Reads it back; columns by their names in the first line, so that more may be there. Errors: InputError
/// with file and line.
std::vector<core::JournalLine> readJournal(const std::string& path);
/// For people: aligned columns, at most 80 wide but for a long detail.
std::string journalText(const std::vector<core::JournalLine>& journal);

/// Where the robot got lost for good: the first `lost` that no `recovered` follows.
std::optional<core::JournalLine> lostInTheEnd(const std::vector<core::JournalLine>& journal);
/// Share of the log's time, from its first to its last scan, that lies between a `lost` and the next
/// `recovered` (or the end). 0 for an empty journal and a log of no length.
double lostShare(const std::vector<core::JournalLine>& journal, double log_seconds);
/// "lost at scan 812 (83.2 s)"
std::string lostText(const core::JournalLine& lost);

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
