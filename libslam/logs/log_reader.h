#pragma once
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/lidar/deskew.h"
#include "libslam/lidar/scan.h"

namespace slam::logs {

/// A scan of one of several lidars.
struct LidarScan {
  std::string lidar;  ///< its sensor label
  lidar::Scan scan;
  std::optional<lidar::Sweep> sweep;  ///< as the log states it (sweep_note.h)
};

/// One scan with the odometry that belongs to it.
struct LogEntry {
  lidar::Scan scan;
  core::Pose2 T_odom_robot;      ///< accumulated odometry at the scan, starting at the identity
  core::Pose2 T_previous_robot;  ///< its increment since the entry before (identity for the first)
  bool has_odometry = false;     ///< false: the log gave none for this step, the two above do not move
  std::string lidar = {};        ///< sensor label of `scan`
  std::optional<lidar::Sweep> sweep = {};  ///< of `scan`, as the log states it
  std::vector<LidarScan> others = {};  ///< what other lidars saw at that moment; only where several are read
};

/// LogReader's words for all lidars of a log.
inline constexpr const char* kAllLidars = "*";

/// What a reader met so far. It reads ahead by up to 100 scans.
struct LogCounts {
  std::uint64_t entries = 0;  ///< top-level objects of the file: actions, frames, bare observations
  std::uint64_t odometry_readings = 0;
  std::uint64_t other_observations = 0;  ///< neither 2D scan nor odometry; skipped
  std::map<std::string, std::uint64_t> scans_by_label;
  bool has_frames = false;             ///< actions or sensory frames
  bool has_bare_observations = false;  ///< observations outside of a frame
};

/// Reads a log of any format that openLog() knows (an MRPT rawlog of either form: actions with sensory
/// frames, or bare observations; a CARMEN log; ...), packed or plain, streaming: memory does not grow with
/// the log.
///
/// Increments. Actions: of the wheel odometry (CActionRobotMovement2D of kind emOdometry, its raw reading),
/// else the mean of a scan matching one, else of a CActionRobotMovement3D; several actions before a scan
/// compose. Bare readings (CObservationOdometry, absolute): of those before the scan in the file, the last
/// one stamped at or before it; those after that one wait, those before it with a later stamp are passed over
/// (logs whose stamps run back hold such: their motion is in the reading that counts). More than 1000 that
/// wait mean clocks that disagree: then the order in the file decides. No new reading since the last scan:
/// has_odometry is false. As soon as a log has shown an action with an increment, its bare readings count no
/// more. What moved before the first scan is dropped: its T_odom_robot is the identity. Scans come in the
/// order of the file.
///
/// Several lidars: `lidars` names labels with commas between them. "" is the main one: the label with the
/// most scans among the first 100 (a tie: the one met first). kAllLidars is the main one and all that come
/// among these 100 beside it and can be taken with it: level to 5 degrees, mounted within 2 m of the robot's
/// centre at a place of its own (two lidars in one place: nobody measured the second), not
/// repeating the readings of another, with stamps that agree with those about it in the file to three periods
/// (at least 0.2 s); remarks() say of which that is not so, and why. The motion of skipped scans goes to the
/// next one kept. Scans of several lidars in one frame, or stamped within a millisecond one after the other,
/// are one entry: the main one's, or else the first, with the rest in `others`. All else are entries of their
/// own, as are several scans of one label in one frame, the later ones without odometry.
///
/// Sweeps: what the log's sweep notes say (sweep_note.h), from where they stand on. A sweep that takes more
/// than 1.2 of the period between the scans of its lidar (the median among the first 100 scans) is none:
/// remarks() say so.
///
/// No-returns that the log gives as distances (a log that knows of no maximum range, or of another one): what
/// is the largest of the first 100 scans' readings, to the last bit, in a hundredth of them, over a tenth of
/// the beams, and ten times as often as any other far distance, is no distance. remarks() say so.
///
/// Stamps: a scan without one gets that of the newest action or odometry reading before it; without either,
/// an InputError.
///
/// Errors (InputError with path): those of openLog() and of the format; of a rawlog: truncated: with the byte
/// offset in the (compressed) file and the number of good entries (LogCounts::entries) before it, which
/// next() gives first; a note of a sweep that is none; lidars named together whose stamps disagree as above;
/// corrupt: with the same, where a packed log is checked whole before its first entry and the number is an
/// estimate; no scan of the named label (then with the labels that are there); a scan that lidar::fromMrpt
/// refuses, or odometry that is not finite: with the number of the entry. The checksum comes first because
/// MRPT's parsers may crash on damaged bytes; a plain log has none, nor has one that is cut: there damage
/// shows only where it breaks the structure. What nobody can tell: a plain log that was cut exactly between
/// two entries.
///
/// Cost: a packed rawlog is unpacked twice.
///
/// MRPT recomputes the distribution of actions of model mmThrun while it loads them, with numbers from its
/// generator of the calling thread. What next() gives does not depend on them, but a method that draws from
/// the same generator gets other ones than with a log of mmGaussian actions (the same ones for the same log).
class LogReader {
 public:
  explicit LogReader(const std::string& path, const std::string& lidars = "");
  ~LogReader();
  /// The next scan, or nullopt at the proper end of the log. Entries before damage come first, then the
  /// error.
  std::optional<LogEntry> next();
  /// How far in the file, 0..1, for progress.
  double fractionRead() const;
  const LogCounts& counts() const;
  /// The label of the scans that next() gives, of several lidars the main one's; "" also before the first
  /// call.
  const std::string& sensorLabel() const;
  /// All labels that next() gives, the main one first; empty before the first call.
  const std::vector<std::string>& lidars() const;
  /// Lines for people: about each lidar that kAllLidars leaves out, each sweep that cannot be, and each lidar
  /// whose no-returns are marked here.
  const std::vector<std::string>& remarks() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// What `rasterslam info` says of a log. Reads it whole, streaming.
struct LogInfo {
  std::string path;
  std::string form;  ///< "action / sensory frame", "observation only", or "mixed"; "empty" without entries
  std::uint64_t file_bytes = 0;
  std::uint64_t entries = 0;  ///< as MRPT's rawlog-edit counts objects
  std::uint64_t scans = 0;    ///< of sensor_label
  std::uint64_t odometry_readings = 0, other_observations = 0;
  double first_time_s = 0, last_time_s = 0;  ///< earliest and latest stamp of a scan
  std::string sensor_label;                  ///< the lidar that LogReader gives
  std::vector<std::string> remarks;          ///< LogReader's
  std::map<std::string, std::uint64_t> scans_by_label;
  int beams = 0;  ///< this and the next four: of the first scan
  double fov_rad = 0, step_rad = 0, max_range_m = 0;
  core::Pose2 T_robot_lidar;
  bool geometry_varies = false;  ///< a later scan differs in one of the five
  double odometry_length_m = 0, median_scan_period_s = 0, longest_gap_s = 0;
  double no_return_share = 0, lost_share = 0;  ///< of all readings
  bool stamps_run_back = false;
};
/// Errors: as LogReader.
LogInfo inspectLog(const std::string& path);

/// InputError when the log holds no scan, or scans of one beam ("… holds 0 laser scans, expected at least
/// 1").
void requireUsable(const LogInfo& info);

}  // namespace slam::logs
