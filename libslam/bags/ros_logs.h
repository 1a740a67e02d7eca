#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libslam/objects/object_stream.h"

namespace slam::bags {

/// ROS bags as streams of MRPT objects: ROS 1 (.bag, format 2.0), ROS 2 in SQLite (.db3) and in MCAP.
///
/// What is read
///   sensor_msgs/LaserScan, MultiEchoLaserScan (the first echo)   CObservation2DRangeScan
///   nav_msgs/Odometry                                            CObservationOdometry
///   tf2_msgs/TFMessage, tf/tfMessage                             the lidar's mounting; odometry, see below
///   nav_msgs/Odometry, geometry_msgs/PoseStamped on a truth topic   CObservationRobotPose, kTruthLabel
/// in the order of the file (.db3: of receive time); ROS 1 and CDR wire forms (both byte orders). Other
/// messages are counted and named in skipped().
///
/// Stamps are those of the messages' headers, rounded to MRPT's 100 ns; a header without one (0) takes the
/// time at which the recorder got the message, and skipped() says how many did.
///
/// Scans. The label is the topic without its first '/'. Beam i is at angle_min + i * angle_increment; the
/// field of view is angle_max - angle_min where the increment agrees with it to a thousandth of a step (the
/// increment is rounded more), else (n - 1) increments. Negative increments: readings turned round. A sweep
/// that is not centred is a turned sensor, as in lidar::toMrpt(). Readings by REP 117: +inf, or >= range_max:
/// no-return; -inf, NaN, or < range_min: lost. A range_max that is not a number above 0 counts as 1000 m.
/// A time_increment that is not 0 comes as a note (sweep_note.h) before the first scan that has it: beam i is
/// measured i increments after the stamp. Intensities are rounded to integers. Scans without readings are
/// skipped.
///
/// Mounting: the transform from the robot's frame to the scan's frame_id through whatever chain /tf and
/// /tf_static hold at that point of the file, in full 3D. The robot's frame is the odometry's child_frame_id,
/// else base_link, else base_footprint. A lidar that hangs upside down (its z axis points below the horizon)
/// comes as the upright one that measures the same: turned by pi about its x axis, with its readings in
/// reverse order. So beams always run counter-clockwise in the robot's plane, which is what lidar::fromMrpt()
/// and MRPT's grid maps take for granted. No transform: the identity, and skipped() says so.
///
/// Odometry: options.odometry_topic, else /odom, else the first Odometry topic in the file that is not a
/// truth topic; in a bag without one, the transform from the frame odom (or odom_combined, or with a prefix:
/// robot1/odom) to its child, which is then the robot's frame.
///
/// A bag is opened twice: its first 10 s (all of it, if no scan, mounting or odometry is found in them) tell
/// odometry and mounting before the first object is given. Memory does not grow with the bag.
///
/// Errors (InputError with the path): missing, empty, another format; damage, with place and reason, after
/// the good objects; messages that are not of the type that their topic has; a bag without any message that
/// is read (with what is there).
struct RosReadOptions {
  std::vector<std::string> truth_topics = {"/ground_truth", "/base_pose_ground_truth"};
  std::string odometry_topic;  ///< "": by the rule above
};

/// By the first 16 bytes of a file.
bool looksLikeRos1Bag(std::string_view first_bytes);
bool looksLikeRos2Db3(std::string_view first_bytes);  ///< any SQLite database
bool looksLikeMcap(std::string_view first_bytes);
/// True for a folder with a metadata.yaml, as `ros2 bag record` makes.
bool looksLikeRos2Folder(const std::string& path);

/// Chunks as they are, bz2 or lz4; the chunks are read in file order, no index is needed. A bag that its
/// recorder did not close (no index), or that is cut, gives its good objects, then the error.
std::unique_ptr<objects::ObjectSource> openRos1Bag(const std::string& path,
                                                   const RosReadOptions& options = {});

/// The file is opened read-only and never written to. Messages that still are in a -wal file beside it are
/// not read, and skipped() says so.
std::unique_ptr<objects::ObjectSource> openRos2Db3(const std::string& path,
                                                   const RosReadOptions& options = {});

/// Chunks as they are, lz4 or zstd; message encodings cdr and ros1; check sums of chunks, data and summary
/// are checked where the file has them. A file without its end (an unfinished recording) gives what is there,
/// then the error.
std::unique_ptr<objects::ObjectSource> openMcap(const std::string& path, const RosReadOptions& options = {});

/// A folder by its metadata.yaml: .db3 or .mcap, one file or several that follow one another.
std::unique_ptr<objects::ObjectSource> openRos2Folder(const std::string& path,
                                                      const RosReadOptions& options = {});

/// What is written
///   CObservation2DRangeScan   sensor_msgs/LaserScan; no-return +inf, lost NaN; the mounting on /tf_static
///   CObservationOdometry      nav_msgs/Odometry on /odom (covariances 0), and odom -> base_link on /tf
///   CObservationRobotPose labelled kTruthLabel   geometry_msgs/PoseStamped on /ground_truth, frame world
/// Other objects are counted and named in dropped(), as are stamps that ROS cannot hold: MRPT's actions and
/// sensory frames must be turned into observations before.
/// A label with "scan" in it is its topic ("front/scan" -> /front/scan); the first other label goes to /scan,
/// later ones to /scan_LABEL. The frame is the topic without '/scan', "laser" for /scan. An object without a
/// stamp takes the one before it.
/// Receive times follow the objects: the stamp, or 1 ns more than the message before where stamps run back or
/// repeat, so that every reader gives the messages in the order in which they were written.
/// Memory: the index, some 300 bytes per MB. Same objects, same bytes.
///
/// ROS 1 bag, not compressed, chunks of 768 KiB, indexed.
std::unique_ptr<objects::ObjectSink> createRos1Bag(const std::string& path);

/// A path that ends in .db3 becomes that file alone; any other a folder with PATH/metadata.yaml and
/// PATH/NAME_0.db3, as `ros2 bag` expects it. Such a folder must not exist.
std::unique_ptr<objects::ObjectSink> createRos2Db3(const std::string& path);

struct McapWriteOptions {
  std::string compression = "zstd";  ///< "none", "lz4", "zstd"
  bool ros1 = false;                 ///< ROS 1 messages and schemas instead of ROS 2's
};
/// Chunks of 1 MiB, with check sums, message indices and a whole summary.
std::unique_ptr<objects::ObjectSink> createMcap(const std::string& path,
                                                const McapWriteOptions& options = {});

}  // namespace slam::bags
