#pragma once
// For the .cpp files of this room only: which lidars of a log are read.
#include <string>
#include <vector>

#include "libslam/logs/log_reader.h"

namespace slam::logs {

/// A scan at the beginning of a log, with how far its lidar leans from the level.
struct SeenScan {
  const LidarScan* scan;
  double tilt_rad;
};

struct LidarChoice {
  std::vector<std::string> labels;       ///< the main one first; empty without scans
  std::vector<std::string> passed_over;  ///< a line about each that is left out
};

/// "front,rear" -> front, rear; nothing for "" and kAllLidars.
std::vector<std::string> namedLidars(const std::string& wanted);
/// The label with the most scans; a tie: the one met first.
LidarChoice mainLidar(const std::vector<SeenScan>& seen);
/// The main one with all that can be taken beside it, by LogReader's rules.
LidarChoice allLidars(const std::vector<SeenScan>& seen);
/// InputError for lidars that were named and whose stamps disagree.
void requireAgreement(const std::string& path, const std::vector<SeenScan>& seen,
                      const std::vector<std::string>& labels);
/// The words for a stated sweep that takes longer than the time between two scans of its lidar; "" for one
/// that can be, and where nothing can be told.
std::string impossibleSweep(const std::vector<SeenScan>& seen, const std::string& label);

}  // namespace slam::logs
