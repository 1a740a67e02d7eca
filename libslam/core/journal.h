#pragma once
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"

namespace slam::core {

/// What a SLAM method may have to say of its own work; what it means there stands with each method
/// (graph::GraphSlam, particles::ParticleFilter).
enum class JournalEvent {
  kDistrusted,
  kLeapt,
  kSilent,
  kRematched,
  kPoor,
  kLost,
  kRecovered,
  kRestarted,
  kJoined,
  kApart,
  kOutside,
  kInside,
  kDegenerate,
  kSearched,
  kFound,
  kConfirmed,
  kDropped,
  kAccepted,
  kRejected,
  kOptimised,
  kCalibrated,
  kResampled,
  kFailed,  ///< the run, not the method itself, writes this and the next
  kInterrupted,
};

/// The event's word in files and tables, and its meaning with that of its value, for people.
struct JournalEventInfo {
  JournalEvent event;
  const char* word;
  const char* meaning;
};
/// All of them, in the order of the enumeration.
const std::vector<JournalEventInfo>& journalEventInfos();
const char* wordOf(JournalEvent event);
/// nullopt: no event has this word.
std::optional<JournalEvent> journalEventOf(const std::string& word);

/// Something that a method has to say of its own work.
struct JournalEntry {
  int scan = 0;  ///< at which it happened, counted from 0
  JournalEvent event = JournalEvent::kDistrusted;
  double value = 0;     ///< see the event
  int other_scan = -1;  ///< the scan that it refers to, -1: none
  std::string detail;   ///< for people, or ""
};

/// The same with its time and place: a line of journal.csv.
struct JournalLine : JournalEntry {
  double time_s = 0;   ///< since the log's first scan
  Point2 place{0, 0};  ///< of the scan, map frame, as the path is in the end
  Point2 other_place{std::numeric_limits<double>::quiet_NaN(),
                     std::numeric_limits<double>::quiet_NaN()};  ///< of the other scan; NaN without one
};

}  // namespace slam::core
