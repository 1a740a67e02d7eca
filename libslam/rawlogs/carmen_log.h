#pragma once
// For the .cpp files of this room only: openLog() and createLog() are the doors.
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "libslam/core/pose2.h"
#include "libslam/objects/object_stream.h"
#include "libslam/rawlogs/unpacking_stream.h"

namespace slam::rawlogs {

// CARMEN's text logs, one message per line:
//   PARAM name value                                                             then of every message:
//   SYNC tag                                                                     ipc_timestamp (s)
//   ODOM x y theta tv rv accel                                                   ipc_hostname
//   FLASER n [ranges] x y theta odom_x odom_y odom_theta       (RLASER: rear)    logger_timestamp
//   TRUEPOS true_x true_y true_theta odom_x odom_y odom_theta
//   ROBOTLASERi type first_angle fov step maximum accuracy remission_mode n [ranges] m [remissions]
//     laser_x laser_y laser_theta odom_x odom_y odom_theta tv rv forward_safety side_safety turn_axis
//   RAWLASERi the same up to the remissions
// in metres and radians; i is a digit. Lines that start with # are remarks. (CARMEN's own reader and writer
// of logs; the message formats also stand as remarks in most logs.)
//
// What a line becomes, all with the line's ipc_timestamp, in the order of the lines:
//   ODOM               CObservationOdometry "ODOMETRY" with velocities (tv, rv)
//   FLASER, RLASER     CObservationOdometry "FLASER_ODOMETRY", then CObservation2DRangeScan "FLASER". A laser
//                      pose that is not odometry and mounting (logs with corrected poses) comes before as
//                      CObservationRobotPose "FLASER_POSE"
//   ROBOTLASERi        likewise "ROBOTLASERi_ODOMETRY" with velocities, and "ROBOTLASERi"
//   RAWLASERi          CObservation2DRangeScan "RAWLASERi"
//   TRUEPOS            CObservationOdometry "TRUEPOS_ODOMETRY" and CObservationRobotPose kTruthLabel
//   any other line     CObservationComment, its text kCarmenLine and the line: PARAM, SYNC, remarks, other
//                      messages (these are counted: skipped()), with the stamp of the message before, or of
//                      the first one: stock icp-slam demands a stamp of everything, and those of PARAM
//                      lines can be of another clock. (A comment in a rawlog has no label.)
// What a line says beside, and changes seldom, comes before its objects as CObservationComment of kCarmenNote
// and "host NAME"; "ODOM accel A"; of ROBOTLASERi "config" (type to remission_mode) and "safety" (the three).
// Such a note holds until the next one of its kind.
//
// With all that the way back gives every field again but these: logger_timestamp (seconds since the log's
// first stamp are written instead), trailing zeros of numbers, digits of a range beyond a float's and of a
// pose or stamp beyond the sixth decimal, remissions (rounded to whole numbers; none unless there is one a
// range), the laser pose within 2e-6 m (FLASER) or 1 mm and 0.001 rad (ROBOTLASER) of odometry and mounting.
// True poses go beside the log (convertLog()).
//
// FLASER and RLASER lines have no field of view. Readings are laser_front_laser_resolution (PARAM, degrees)
// apart; without it 1 deg (180 or 181 readings), 0.5 deg (360, 361, 200, 201, 540, 541), 0.25 deg (400, 401,
// 1080, 1081), 1 deg (100, 101); any other number spreads over 180 deg. An even number is a sweep without its
// last reading: 180 readings span 179 deg, from -90. The sweep begins at minus half of
// laser_front_laser_fov (PARAM, degrees), or of itself.
// The laser stands at x = robot_frontlaser_offset (PARAM; 0 without). The rear one (laser_rear_...,
// robot_rearlaser_offset, robot_rear_laser_max) looks back, and its offset has the sign that the line's two
// poses show. ROBOTLASERi: mounting as the line's two poses show, rounded to 1e-4 and kept until a line
// differs by more than 1 mm or 0.001 rad. RAWLASERi: mounted at the robot's centre.
// No-returns: readings at or beyond robot_front_laser_max (PARAM), else 80 m: what the SICK scanners of these
// logs put above it are codes (81.83, 81.91), and CARMEN's reader assumes the same. ROBOTLASERi, RAWLASERi:
// at or beyond the line's own maximum. They keep their value and are marked invalid, as are readings <= 0. A
// parameter holds for the lines after it.

inline constexpr std::string_view kCarmenLine = "CARMEN line: ";
inline constexpr std::string_view kCarmenNote = "CARMEN note: ";
inline constexpr const char* kOdometrySuffix = "_ODOMETRY";
inline constexpr const char* kPoseSuffix = "_POSE";

class CarmenWords;

/// What PARAM lines say of the lasers of FLASER and RLASER lines.
class CarmenSettings {
 public:
  struct Geometry {
    double first_angle_rad = 0, step_rad = 0, max_range_m = 0;
    core::Pose2 T_robot_lidar;
  };
  /// A PARAM line's name and value; others than those above are passed over. InputError: a value that is no
  /// number or out of bounds.
  void take(std::string_view name, std::string_view value);
  /// A line of a log: of one that is PARAM, its name and value.
  void takeLine(std::string_view line);
  /// Of a sweep of so many readings; is_rear: RLASER. T_odom_robot, T_odom_laser: what the line says.
  Geometry geometry(size_t readings, bool is_rear, const core::Pose2& T_odom_robot,
                    const core::Pose2& T_odom_laser) const;

 private:
  struct Laser {
    std::optional<double> offset_m, max_range_m, step_deg, fov_deg;
  };
  Laser front_, rear_;
};

/// The objects of CARMEN lines, line by line.
class CarmenParser {
 public:
  using Objects = std::deque<std::shared_ptr<mrpt::serialization::CSerializable>>;
  /// Appends what the line (without its newline) becomes. Errors (InputError without a place): a field of one
  /// of the messages above that is missing, no finite number, or out of bounds; more fields than the message
  /// has.
  void take(std::string_view line, Objects& objects);
  /// What waits for the stamp of a first message, when no line is left.
  void finish(Objects& objects);
  /// Scans of fewer than 2 readings count here too: they are kept as text.
  std::string skipped() const;

 private:
  struct Sweep;
  void takeOdometry(CarmenWords& words, Objects& objects);
  void takeTruth(CarmenWords& words, Objects& objects);
  void takeOldLaser(const std::string& kind, CarmenWords& words, Objects& objects);
  void takeNewLaser(const std::string& kind, CarmenWords& words, Objects& objects);
  void takeText(std::string_view line, Objects& objects);
  void begin(double time_s, const std::string& host, Objects& objects);
  void note(const std::string& key, const std::string& value, double time_s, Objects& objects);

  CarmenSettings settings_;
  std::map<std::string, std::string> notes_;
  std::map<std::string, core::Pose2> mounts_;
  std::map<std::string, std::uint64_t> skipped_;
  std::deque<std::string> waiting_;  ///< text before the first message
  std::int64_t newest_ticks_ = 0;    ///< kNoStamp before it
};

/// True when this start of a file (64 KiB, or all of it) is text with a line of one of the messages above.
bool looksLikeCarmen(std::string_view start);

/// The objects of a CARMEN log, plain or packed. Errors (InputError): `path:line: ` and the parser's words; a
/// line of more than 1 MiB; truncated (packed data that end too early, or a last line that has no newline and
/// is not whole); damaged. What comes before is given first; the reader does not go on after an error, for a
/// line that is none of its message's may be the first of many. Messages of unknown kinds it passes over,
/// counted.
class CarmenObjects : public objects::ObjectSource {
 public:
  explicit CarmenObjects(const std::string& path);
  std::shared_ptr<mrpt::serialization::CSerializable> next() override;
  std::uint64_t count() const override { return count_; }
  double fractionRead() const override;
  std::string place() const override { return "line " + std::to_string(line_); }
  std::string skipped() const override { return parser_.skipped(); }

 private:
  bool readLine();
  [[noreturn]] void failAtEnd() const;

  std::string path_;
  UnpackingStream stream_;
  CarmenParser parser_;
  CarmenParser::Objects ready_;
  std::uint64_t line_ = 0, count_ = 0;
};

/// Writes observations as CARMEN lines: the way back of what is said above. Other logs' objects: a scan
/// becomes a ROBOTLASERi line, i = 1 for the lidar met first, with its field of view, maximum and mounting,
/// and the newest odometry reading before it (or 0 0 0); readings that are lost are written as 0, no-returns
/// at or above the maximum; odometry becomes ODOM; a comment becomes remarks; a scan or reading without a
/// stamp gets the newest one. Actions and frames are for a step before; they and all other objects are
/// counted and dropped. Plain text whatever the name.
std::unique_ptr<objects::ObjectSink> createCarmenLog(const std::string& path);

}  // namespace slam::rawlogs
