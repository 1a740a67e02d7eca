#pragma once
#include <string>
#include <utility>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/record/step_observer.h"
#include "libslam/viewer/layers.h"

namespace slam::live {

/// A finished run, to be shown again: the scans of its log at the poses that it gave them in the end.
struct Replay {
  std::string log_path, method;
  core::Trajectory path;  ///< T_map_robot by the stamp: corrected, where the method corrects its past
  /// Loops that the method closed, in the frame of the first pose, and the scan at which it did, in their
  /// order.
  std::vector<std::pair<int, viewer::Connection>> loops;
};

/// Reads a folder that run::buildMap() or explore::explore() wrote. given_log: "" = the one in the folder or,
/// by the manifest, the one that the run was made from, by its path. Errors: InputError (no such folder, no
/// log, another log than the run's).
Replay loadReplay(const std::string& folder, const std::string& given_log);

/// Goes through the log once more; the observer's method draws the map at the path's poses, in the frame of
/// its first one, as the observer is given the poses. What it throws ends it.
/// Errors: InputError when a scan has no pose within a microsecond.
void play(const Replay& replay, record::StepObserver& observer);

}  // namespace slam::live
