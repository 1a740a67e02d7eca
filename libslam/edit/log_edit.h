#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"

namespace slam::edit {

// Cutting, merging and filtering logs. In: any format that logs::openLog() reads. Out: an MRPT rawlog, gzip
// inside, written beside (files::PendingFile) and renamed at the end, so an error or an interrupt leaves
// nothing behind.
//
// What is not touched stays as it is: of a rawlog, the bytes of each object are copied (older class versions,
// other classes and noise-free digits included); objects of other formats are those of logs::openLog(). In a
// log of MRPT's action form an action stays with the frame that it leads to: both are kept or dropped
// together.
//
// When a step in the middle is dropped (its frame, with its actions), its increment is composed with that of
// the next step kept, so that the robot ends where it did: of wheel odometry the raw readings (the motion
// model of the last one is applied to the sum; encoder ticks add up), of scan matching and spatial actions
// mean and covariance. A step without an increment adds none. Other actions of a dropped step are dropped
// with it. What a cut takes off the two ends is not composed: the first action kept says how the robot came
// to the first frame, as in any log.
//
// Errors: as logs::openLog(); IoError for the output; InputError when nothing would be left. Interrupted from
// `progress`. Memory does not grow with the log.

/// What became of the objects of the top level (of both logs, in a merge).
struct EditCounts {
  std::uint64_t read = 0;
  std::uint64_t unchanged = 0;
  std::uint64_t changed = 0;   ///< written with other content
  std::uint64_t composed = 0;  ///< actions that took up those of dropped steps; counted in `changed` too
  std::uint64_t dropped = 0;
  std::string damage;  ///< the reader's words, where salvage ended the log before its end
};

/// A moment, in seconds: after the first stamp of the file, or since the Unix epoch.
struct LogMoment {
  double seconds = 0;
  bool is_absolute = false;
};

struct CutOptions {
  std::optional<LogMoment> from;  ///< the first moment kept
  std::optional<LogMoment> to;    ///< the first moment dropped again
  bool salvage = false;           ///< a log that breaks off: keep what comes before, and say so
};
/// Keeps the objects with from <= stamp < to, in the file's order, whatever it is. An object without a stamp
/// goes with the one before it; those before the first stamp are kept (they are a log's parameters).
EditCounts cutLog(const std::string& path, const std::string& output, const CutOptions& options,
                  core::Progress& progress);

/// One log from two, by stamp: at each point the log whose next object is older gives it; equal stamps: the
/// first log. Each log keeps its own order, also where its stamps run back; an object without a stamp stays
/// behind the one before it. Errors, besides those above: both logs hold actions and overlap in time (the
/// robot would move twice).
EditCounts mergeLogs(const std::string& first, const std::string& second, const std::string& output,
                     core::Progress& progress);

struct FilterOptions {
  std::vector<std::string> keep_labels;  ///< observations of other labels are dropped; empty: none is
  std::vector<std::string> drop_labels;
  bool drop_truth = false;  ///< observations labelled objects::kTruthLabel
  /// Of each lidar's scans the first of every so many is kept; in frames, of the frames with a 2D scan.
  std::uint64_t every = 1;

  // What the log says wrongly. The first three are about all its 2D scans.
  std::optional<double>
      no_return_m;  ///< readings from here on are none: marked invalid, maximum range set to it
  std::optional<double> step_rad;         ///< angle between two readings; the middle of the sweep stays
  std::optional<core::Pose2> mount;       ///< x, y and yaw of the lidar on the robot
  std::map<std::string, double> shift_s;  ///< by label: added to its stamps
};
/// A frame from which everything was dropped is dropped as a step. Errors, besides those above: a label that
/// the log does not have (with those that it has); a shifted stamp outside of mrptTicks()'s bounds; a step
/// that makes a sweep of more than 360 degrees.
EditCounts filterLog(const std::string& path, const std::string& output, const FilterOptions& options,
                     core::Progress& progress);

}  // namespace slam::edit
