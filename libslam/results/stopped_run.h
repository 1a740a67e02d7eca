#pragma once
#include <functional>
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/results/journal_file.h"

namespace slam::results {

/// Why a run ended before its log did. What was mapped until then is kept.
struct Stop {
  enum class Reason { kFailed, kInterrupted };
  Reason reason = Reason::kFailed;
  int scan = 0;  ///< that was not taken in, counted from 0; the number of scans when the method failed after
                 ///< the last
  double time_s = 0;  ///< of that scan, since the log's first
  std::string why;    ///< of a failure, one line
};

/// "at scan 813 (83.2 s): the odometry is not finite"
std::string stopText(const Stop& stop);

/// kFailed or kInterrupted; its word is the key in a manifest's results.
core::JournalEvent eventOf(const Stop& stop);

/// The journal's last line, at the last scan that was taken in.
core::JournalLine stopLine(const Stop& stop, const core::Pose2& T_map_robot);

/// Does what a method is asked to do. Whatever it throws because it has failed becomes a core::MethodError of
/// one line. What says nothing about the method goes on as it is: core::Interrupted, core::IoError, and
/// memory that ran out.
void insideMethod(const std::function<void()>& work);

}  // namespace slam::results
