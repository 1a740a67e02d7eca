#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "libslam/calibration/odometry_fit.h"
#include "libslam/calibration/odometry_tally.h"
#include "libslam/calibration/range_tally.h"
#include "libslam/calibration/stamp_tally.h"
#include "libslam/calibration/sweep_fit.h"
#include "libslam/calibration/view_fit.h"
#include "libslam/core/progress.h"

namespace slam::doctor {

/// What was seen in a log, as plain figures.
struct LogFigures {
  std::string path, format;
  std::uint64_t file_bytes = 0;
  std::uint64_t objects = 0;
  bool has_frames = false, has_bare_observations = false;
  std::string damage;                               ///< the reader's words where the log breaks off, or ""
  std::string skipped;                              ///< as ObjectSource::skipped()
  double first_s = 0, last_s = 0;                   ///< earliest and latest stamp of all
  std::vector<calibration::StreamFigures> streams;  ///< by kind and label
  std::uint64_t backward_in_file = 0;  ///< objects stamped earlier than the one before, of whichever stream
  double largest_backward_in_file_s = 0;

  std::string lidar;  ///< label of the one that was looked at
  calibration::RangeFigures ranges;
  bool is_view_given = true;  ///< false: the log does not say the field of view, the reader took it from the
                              ///< number of readings
  std::string refused_scan;   ///< the words about the first scan that no method here can take, or ""
  std::uint64_t refused_scans = 0;
  std::uint64_t scans_without_time = 0;  ///< no stamp, and none of odometry before them

  std::uint64_t matched_pairs = 0, unmatched_pairs = 0, unsure_pairs = 0;  ///< of consecutive scans
  double first_unmatched_s = 0;
  calibration::ViewFit view;
  std::optional<lidar::Sweep> stated_sweep;  ///< of the lidar, where the log says it (objects/sweep_note.h)
  calibration::SweepFit sweep;
  std::vector<calibration::OdometryFigures> odometry;  ///< by stream
  int best_odometry = -1;  ///< the one that agrees best with the scans; the next three are of it
  calibration::OdometryFit fit;
  std::uint64_t disagreements =
      0;  ///< steps where scans and odometry differ by half a metre or half a radian
  double largest_disagreement_m = 0, largest_disagreement_rad = 0, largest_disagreement_at_s = 0;
  bool has_truth = false;
};

enum class Severity { kNote, kWarning, kError };
std::string severityName(Severity severity);  ///< "note", "warning", "error"

struct Finding {
  std::string key;  ///< one of findingKeys()
  Severity severity = Severity::kNote;
  std::string text;    ///< what was found, with the evidence in figures: one line
  std::string advice;  ///< what to do about it, one line; "" where there is nothing to do
};

/// All keys in the order in which findings come, with what they are about.
struct FindingKey {
  std::string key, meaning;
};
const std::vector<FindingKey>& findingKeys();

struct LogCheck {
  LogFigures figures;
  std::vector<Finding> findings;
  bool isUsable() const;  ///< no finding is an error
  int warnings() const;
};

/// Looks a log of any format over: reads it once for stamps and readings, and once more to match its scans
/// with one another (plicp) and its odometry with them. Nothing in the log is believed without evidence where
/// the scans can give it: field of view, mounting pose, scale, clocks.
///
/// lidar: the label to look at, "" for the one with the most scans (a tie: the first by name).
/// Memory does not grow with the log: of long series a sample is kept, at most 20000 scans are matched, and
/// the first 8 lidars and 8 sources of odometry are looked at. Cost:
/// reading twice and about 0.1 to 0.3 ms per matched scan.
/// Errors (InputError): as logs::openLog(), before the first object; a lidar that is not there. What breaks
/// later is a finding. Interrupted from `progress`.
LogCheck checkLog(const std::string& path, const std::string& lidar, core::Progress& progress);

/// The streams of a log alone: one quick pass. Errors (InputError): as logs::openLog(), and a log that breaks
/// off.
std::vector<calibration::StreamFigures> streamsOf(const std::string& path);

/// The rules alone: what the figures mean and what to do.
std::vector<Finding> findingsOf(const LogFigures& figures);

}  // namespace slam::doctor
