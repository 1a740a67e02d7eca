#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "libslam/core/progress.h"
#include "libslam/odometry/scan_odometry.h"
#include "libslam/rawlogs/rawlog_form.h"

namespace slam::run {

/// What the robot was commanded to do before this scan, where somebody knows it (argmax asks). `wheels`: the
/// increment since the scan before by the log's own odometry, where it has one.
using CommandBefore =
    std::function<odometry::Commanded(const lidar::Scan& scan, const std::optional<core::Pose2>& wheels)>;

struct ScanOdometryLogOptions {
  odometry::ScanOdometryOptions odometry;
  std::string label;  ///< the lidar; "": the one with the most scans among the first 100 (LogReader's rule)
  std::optional<rawlogs::RawlogForm> form;  ///< turned into it first; none: as the log is
  CommandBefore commanded;                  ///< none: MotionKind::kUnknown
};

struct ScanOdometryLogReport {
  std::string label;             ///< of the lidar
  std::uint64_t motions = 0;     ///< written
  std::uint64_t unreliable = 0;  ///< of them: too few returns, or an ambiguous fit
  std::uint64_t replaced = 0;    ///< movement actions and odometry readings of the log, left out
  std::uint64_t written = 0;     ///< objects
  std::string skipped;           ///< the source's words
};

/// A log with odometry from its scans alone in place of its own: an MRPT rawlog for stock programs, which
/// need odometry (rbpf-slam stops without). Reads any format of openLog(); writes gzip inside, beside and
/// renamed at the end. The output holds no movement but ours: CActionRobotMovement2D and 3D and
/// CObservationOdometry of the log, also inside frames, are left out. All else passes, written again by this
/// version of MRPT.
///
/// Action form: before each frame one CActionCollection: other actions of the log, and the motion since the
/// scan before as odometry::toMrptActions() has it (mean, covariance, motion model), stamped as the scan. A
/// frame without a scan of the lidar gets no motion, and the next one with a scan all of it; of several scans
/// in a frame the first counts. Observation form: before each scan a CObservationOdometry "ODOMETRY", the
/// motions composed from the origin; the form has no room for covariance. rbpf-slam crashes on that form:
/// give `form` kActionFrame for it.
///
/// A stamp that is missing is that of the newest object before. The first motion is null. Memory does not
/// grow with the log. The same log, the same bytes.
/// Errors (InputError): those of openLog() and inForm(); unknown method; no scan of the lidar, or one that
/// lidar::fromMrpt refuses (with its place); frames and bare scans of the lidar in one log without `form`; a
/// first scan without any stamp.
ScanOdometryLogReport writeScanOdometry(const std::string& path, const std::string& output,
                                        const ScanOdometryLogOptions& options, core::Progress& progress);

}  // namespace slam::run
