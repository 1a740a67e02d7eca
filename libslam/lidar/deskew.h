#pragma once
#include "libslam/core/pose2.h"
#include "libslam/lidar/scan.h"

namespace slam::lidar {

struct LidarOptions;

/// The sweep of a simulated lidar as its data sheet would say it; its latency is nobody's to know.
Sweep sweepOf(const LidarOptions& options);

/// How long before the scan's stamp a beam was measured, s; below 0 after it. `beam`: an index, or between
/// two. REQUIRES 2 beams.
double measuredAgo_s(const Scan& scan, const Sweep& sweep, double beam);

/// Deskews: the scan as if taken all at once at its stamp, by a robot that moved as T_previous_robot says in
/// the `period_s` before, at constant speed (also for what is measured after the stamp). Every reading
/// becomes a point where it was measured, and the beam table is cast anew on these: between two neighbours on
/// one surface on the line through them, else the nearer one's range. So a scan stays ranges at fixed angles,
/// as grids, odometries and matchers here take it.
/// Beams that no reading covers any more (at an end of the view, where the robot turned) are lost readings;
/// MRPT's stock grid, unlike the exact one, clears along those. Readings without a return only turn. The same
/// scan where the sweep or the motion is null. REQUIRES finite motion, period_s > 0. Cost: a sort of the
/// beams. The scan keeps by what (Scan::deskewing): what the motion errs by is still in it.
Scan deskewed(const Scan& scan, const core::Pose2& T_previous_robot, double period_s, const Sweep& sweep);

}  // namespace slam::lidar
