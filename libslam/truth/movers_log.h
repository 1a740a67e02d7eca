#pragma once
#include <string>
#include <vector>

#include "libslam/files/files.h"
#include "libslam/sim/simulator.h"

namespace slam::truth {

/// Where people were, world frame, row by row of the file that a MoversLog leaves beside a log or its truth;
/// none where there is no such file. Errors: InputError with file and line.
std::vector<core::Point2> readPeople(const std::string& log_or_truth_path);

/// The truth of what moved besides the robot, beside a log, written as it comes:
///
///     time_s,kind,id,x_m,y_m,heading_rad,state
///     1700000000.2,person,0,4.131,2.208,1.571,walking      walking | waiting | pausing
///     1700000000.2,door,3,7.25,3.1,,closed                 open | closed | held (would close, but somebody
///                                                          stands there)
///
/// World frame; the time is that of the scan, and where things are is what the scan saw. Every person at
/// every scan, every door that moves at the first scan and then when its state has changed. A door's place is
/// the middle of its opening.
class MoversLog {
 public:
  /// Errors: IoError.
  explicit MoversLog(const std::string& path);
  void add(const sim::Simulator& simulator);
  /// Without it nothing is left. Errors: IoError.
  void commit();

 private:
  files::GrowingFile file_;
  std::vector<movers::DoorState> doors_;  ///< as last written
};

}  // namespace slam::truth
