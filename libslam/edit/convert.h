#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libslam/core/progress.h"
#include "libslam/logs/log_format.h"
#include "libslam/logs/trajectory_io.h"
#include "libslam/objects/object_stream.h"
#include "libslam/rawlogs/rawlog_form.h"

namespace slam::edit {

struct LogConversion {
  logs::LogFormat to = logs::LogFormat::kRawlog;
  /// Of kRawlog. Other formats know observations only. None: the observations of a log that has no actions,
  /// and each object as it comes of one that has.
  std::optional<rawlogs::RawlogForm> form;
  std::string label;  ///< keep only the scans of this lidar; "" keeps all
  bool overwrite = false;
};

struct ConversionReport {
  logs::LogFormat from = logs::LogFormat::kRawlog;
  std::map<std::string, std::uint64_t> scans_by_label;  ///< written
  std::uint64_t odometry_readings = 0;                  ///< written: observations, or actions
  std::uint64_t comments = 0, other_observations = 0;   ///< written
  std::uint64_t scans_left_out = 0;                     ///< of other lidars
  std::uint64_t true_poses = 0;                         ///< written beside the log
  std::string skipped, dropped;                         ///< the source's and the sink's words
  std::vector<std::string> files;
};

/// Writes a log again, in another format or form. Poses labelled objects::kTruthLabel do not go into it but
/// beside it, in the order of their stamps: STEM.truth.tum (STEM: logs::logStem(out)) and MRPT's OUT.GT.txt.
/// Memory does not grow with the log but for its true poses (32 bytes each). The files appear whole at the
/// end or not at all.
///
/// Errors: those of logs::openLog(), its format's reader, inForm() and logs::createLog(); InputError when a
/// file that would be written exists and `overwrite` is not set, when no scan has the label (naming those
/// there are), when the log holds nothing that can be written.
ConversionReport convertLog(const std::string& in, const std::string& out, const LogConversion& conversion,
                            core::Progress& progress);

/// Where a log's trajectory comes from.
enum class LogPath {
  kOdometry,  ///< the odometry at each scan that LogReader gives, from the identity
  kTruth      ///< the poses labelled objects::kTruthLabel
};

/// A log's trajectory as a file, in the order of stamps. Keeps the poses in memory (32 bytes each). Errors:
/// those of LogReader or logs::openLog(); no scan, no pose.
std::size_t exportTrajectory(const std::string& in, LogPath path, const std::string& label,
                             const std::string& out, logs::TrajectoryWriter::Format format, bool overwrite,
                             core::Progress& progress);

}  // namespace slam::edit
