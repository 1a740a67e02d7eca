#pragma once
#include <string>

#include "libslam/core/pose2.h"
#include "libslam/files/files.h"

namespace slam::logs {

/// Trajectories as text. Readers pass over blank lines and lines that start with # or %; they take equal
/// stamps but none that runs back, and know no locale. Errors (InputError with file:line): too few or too
/// many numbers, a number that is malformed or not finite, stamps that run back, a quaternion of length 0; no
/// pose at all; and those of files::readTextFile.
/// Writers give the same bytes for the same poses and leave a whole file or none. REQUIRES at least one pose,
/// finite numbers, stamps that do not run back (ContractError). Errors: IoError with the path.

/// TUM: `time x y z qx qy qz qw` per line. Written with 6 decimals of a second and 9 of metres, below a
/// comment that names the columns. Reading drops z, roll and pitch (heading as yaw of z, y', x'').
void writeTum(const core::Trajectory& trajectory, const std::string& path);
core::Trajectory readTum(const std::string& path);

/// MRPT's convention beside a rawlog, NAME.rawlog.GT.txt: `time x y phi` per line, relative to the start
/// pose, 6 decimals, no comment.
void writeMrptGroundTruth(const core::Trajectory& truth, const std::string& path);
core::Trajectory readMrptGroundTruth(const std::string& path);

/// The writers' files pose by pose, for a trajectory that is not kept. kCsv: `time_s,x_m,y_m,yaw_rad`, below
/// a line with these names, 6 decimals of a second and 9 of metres and radians; yaw in (-pi, pi]. Pose by
/// pose the same bytes and the same requirements; close() without a pose is a ContractError too. Without
/// close() nothing is left.
class TrajectoryWriter {
 public:
  enum class Format { kTum, kMrptGroundTruth, kCsv };
  TrajectoryWriter(const std::string& path, Format format);
  void write(const core::StampedPose& pose);
  void close();

 private:
  files::GrowingFile file_;
  Format format_;
  bool is_first_ = true;
  core::Pose2 start_;
  double last_time_s_ = 0;
  std::string line_;
};

void writeTrajectory(const core::Trajectory& trajectory, const std::string& path,
                     TrajectoryWriter::Format format);

/// By content: four numbers in the first line of numbers is MRPT's, eight is TUM, commas are CSV (as kCsv;
/// the line with the names may be missing).
core::Trajectory readTrajectory(const std::string& path);

/// The Freiburg benchmark's ground truth for real logs (Kümmerle et al., Autonomous Robots 27(4), 2009): per
/// line `t1 t2 x y z roll pitch yaw`, the pose of t2 seen from t1, in seconds, metres and radians. z, roll
/// and pitch are dropped. Blank lines and lines that start with # are passed over; no locale. Errors
/// (InputError with file:line): another number of columns, a number that is malformed or not finite, no
/// relation at all; and those of files::readTextFile().
core::Relations readRelations(const std::string& path);

/// The text that reads back to the same but for the sixth decimal. REQUIRES finite numbers and at least one
/// relation (ContractError). Errors: IoError; whole or not at all.
void writeRelations(const core::Relations& relations, const std::string& path);

}  // namespace slam::logs
