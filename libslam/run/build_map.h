#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/pose2.h"
#include "libslam/core/progress.h"
#include "libslam/files/ini.h"
#include "libslam/record/step_observer.h"
#include "libslam/resources/manifest.h"
#include "libslam/results/cost.h"
#include "libslam/results/journal_file.h"
#include "libslam/results/pose_covariances.h"
#include "libslam/results/relative_covariances.h"
#include "libslam/results/stopped_run.h"
#include "libslam/run/earlier_map.h"

namespace slam::run {

struct MapRun {
  core::Trajectory
      estimate;  ///< T_map_robot at every scan, as the method gave it online, in the order of stamps
  std::optional<core::Trajectory>
      final_estimate;  ///< the same in the end, where the method corrects its past
  std::vector<results::StampedCovariance>
      covariances;  ///< of `estimate`, pose by pose; empty where the method gives none
  std::vector<results::StampedCovariance> final_covariances;  ///< the same of `final_estimate`
  std::vector<results::RelativeCovariance> relative_covariances;
  double path_length_m = 0;  ///< of the poses given online; this and the next in the order of the log
  core::Pose2 end;           ///< T_map_robot at the last scan
  results::Cost cost;
  int steps_without_odometry = 0;  ///< scans after the first for which the log gives no increment
  std::string commands_from;       ///< tellCommands()
  std::vector<std::string> lidars,
      remarks;                             ///< of the log's reader: whose scans were taken; lines for people
  std::string skew_note;                   ///< skewNote()
  int filled_poses = 0;                    ///< scans that an external program gave no pose
  std::vector<core::JournalLine> journal;  ///< empty for methods that keep none
  std::optional<double> lost_share;  ///< of the time, by the journal (lostShare()); none without a journal
  std::optional<results::Stop> stopped;  ///< before the log's end; all else is of the scans before
};

/// What else buildMap() may be told. Only the continuation decides bytes.
struct BuildOptions {
  bool measure_memory = true;  ///< only makes sense while nothing else runs in this process
  Continuation continuation = {};
  record::StepObserver* observer = nullptr;
  bool keep_partial = false;  ///< an interrupt keeps what was mapped until then
  /// 2 or more: the log is read ahead, methods take what they can use (mapping::useThreads()), and when all
  /// scans are in, they are held against the map while that is written.
  int threads = 1;
  /// Of the log: how sure the method is of the motion between their stamps goes into
  /// covariances_relative.csv. What they say of it is not looked at.
  core::Relations relations = {};
};

/// Runs a SLAM method over a log and writes a folder:
///   trajectory.tum   map.yaml + map.png   map.gridmap.gz   map.simplemap   map.3Dscene   timing.csv
///   manifest.json
///   trajectory_final.tum    where mapping::finalPath() has one
///   covariances.csv         of the poses given online, where the method gives any (pose_covariances.h);
///                           covariances_final.csv: of the others; covariances_relative.csv: of pairs of
///                           those (relative_covariances.h)
///   graph.g2o               of type graph
///   journal.csv             where the method keeps one
/// An external method (external_method.h) has printed.txt instead of timing.csv, what it printed; this, like
/// its poses, is as repeatable as the program is. Trajectories are written in the order of their stamps,
/// which in a log may run back. The manifest's results also hold what needs the scans to say it: sharpness of
/// the points and agreement of scans and map (keys `self.*`; self_score.h), placed at the final poses where
/// there are any. The folder appears whole or not at all. Same log, config and seed: the same bytes but for
/// timing.csv and the manifest, with any number of threads.
/// Errors: InputError (log, config, a method that cannot go on in a map), MethodError (the method failed at
/// the first scan, or is an external program that failed). A robot that is lost in the end (lostInTheEnd())
/// is no error: all is written, and the manifest's results say `lost`.
/// A method that fails later is no error either: the folder holds what was mapped before, without what the
/// method can no longer give (such as covariances, or a map that has come apart) and without `self.*`; the
/// journal ends with `failed`, the manifest's results say `status` = incomplete and `failed` = where and why.
/// keep_partial: an interrupt likewise (`interrupted`), unless no scan was taken in; without it an interrupt
/// leaves nothing (core::Interrupted).
MapRun buildMap(const std::string& log_path, const files::IniFile& method_config,
                const std::string& method_name, std::uint64_t seed, const std::string& folder, bool overwrite,
                resources::Manifest manifest, core::Progress& progress, const BuildOptions& options = {});

}  // namespace slam::run
