#pragma once
#include <map>
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"
#include "libslam/results/self_score.h"
#include "libslam/results/stopped_run.h"

namespace slam::results {

// What a run's manifest.json says, key by key.

/// The files that a run may write, and what each is.
const std::map<std::string, std::string>& fileNotes();

/// What scoring a map needs to know of the lidar: keys `lidar.*` of a run's manifest.
void describeLidar(const lidar::Scan& scan, std::map<std::string, std::string>& results);
/// Keys `NAME.x_m`, `NAME.y_m` and `NAME.yaw_rad`.
void describePose(const std::string& name, const core::Pose2& pose,
                  std::map<std::string, std::string>& results);
/// Keys `self.*`.
void describeSelfScore(const SelfScore& score, std::map<std::string, std::string>& results);
/// Keys `status` and `failed` or `interrupted`.
void describeStop(const Stop& stop, std::map<std::string, std::string>& results);

}  // namespace slam::results
