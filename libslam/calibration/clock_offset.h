#pragma once
#include "libslam/calibration/estimate.h"
#include "libslam/calibration/motion_series.h"

namespace slam::calibration {

/// How far the odometry's clock is from that of the scans.
struct ClockOffset {
  bool is_observable = false;  ///< enough turning, one clear best offset, interval below half a second
  Estimate offset_s;           ///< to add to the odometry's stamps; positive: the odometry leads
  double correlation = 0;      ///< of the turns at the best offset
  double correlation_at_zero = 0;
  double turned_rad = 0;  ///< by the scans, absolute turns summed
};

/// Looks where the turns between scans correlate best with the odometry's turns over the same time, shifted
/// by up to 3 s either way; to a fraction of a period, because the odometry's heading is taken as straight
/// between its readings. The interval is from 200 bootstrap samples of about 40 parts of the log (Künsch,
/// Annals of Statistics 17(3), 1989: blocks keep what hangs together in time).
ClockOffset findClockOffset(const std::vector<Stretch>& stretches, const std::string& stream);

}  // namespace slam::calibration
