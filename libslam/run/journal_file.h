#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/journal.h"
#include "libslam/core/pose2.h"

namespace slam::run {

/// A journal's entry with its time and place: a line of journal.csv. Which events there are is for the method
/// to say (graph::GraphSlam, particles::ParticleFilter).
struct JournalLine {
  int scan = 0;
  double time_s = 0;  ///< since the log's first scan
  std::string event;
  double value = 0;
  int other_scan = -1;       ///< the scan that it refers to, -1: none
  core::Point2 place;        ///< of the scan, map frame, as the path is in the end
  core::Point2 other_place;  ///< of the other scan; NaN without one
  std::string detail;
};

/// stamps_s and path: of every scan, in the log's order; not empty.
std::vector<JournalLine> placedJournal(const std::vector<core::JournalEntry>& journal,
                                       const std::vector<double>& stamps_s, const core::Trajectory& path);

std::string journalCsv(const std::vector<JournalLine>& journal);
/// Reads it back; columns by their names in the first line, so that more may be there. Errors: InputError
/// with file and line.
std::vector<JournalLine> readJournal(const std::string& path);
/// For people: aligned columns, at most 80 wide but for a long detail.
std::string journalText(const std::vector<JournalLine>& journal);

/// Where the robot got lost for good: the first `lost` that no `recovered` or `found again` follows.
std::optional<JournalLine> lostInTheEnd(const std::vector<JournalLine>& journal);
/// Share of the log's time, from its first to its last scan, that lies between a `lost` and the next
/// `recovered` or `found again` (or the end). 0 for an empty journal and a log of no length.
double lostShare(const std::vector<JournalLine>& journal, double log_seconds);
/// "lost at scan 812 (83.2 s)"
std::string lostText(const JournalLine& lost);

}  // namespace slam::run
