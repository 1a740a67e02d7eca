#pragma once
#include <string>

#include "libslam/core/pose2.h"

namespace slam::logs {

/// TUM: `time x y z qx qy qz qw` per line, `#` comments. Written with 6 decimals of a second and 9 of metres.
/// Reading: z, roll and pitch are dropped; errors (InputError) with file:line: too few numbers, nan,
/// quaternion of length 0, stamps that run back, no pose at all.
void writeTum(const core::Trajectory& trajectory, const std::string& path);
core::Trajectory readTum(const std::string& path);

/// MRPT's convention beside a rawlog, NAME.rawlog.GT.txt: `time x y phi` per line, relative to the start
/// pose.
void writeMrptGroundTruth(const core::Trajectory& truth, const std::string& path);
core::Trajectory readMrptGroundTruth(const std::string& path);

/// By content: four numbers a line is MRPT's, eight is TUM.
core::Trajectory readTrajectory(const std::string& path);

}  // namespace slam::logs
