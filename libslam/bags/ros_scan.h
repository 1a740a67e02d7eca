#pragma once
#include <mrpt/obs/CObservation2DRangeScan.h>

#include "libslam/bags/ros_messages.h"
#include "libslam/lidar/deskew.h"

namespace slam::bags {

// A laser scan's message, part by part, as MRPT has it.

/// A sweep's angles with the readings in counter-clockwise order of the lidar's own frame.
struct ScanAngles {
  double first_rad = 0, aperture_rad = 0;
  bool reversed = false;
};
ScanAngles anglesOf(const RosLaserScan& scan);

/// Beam i of the message is measured at the stamp + i * time_increment; `reversed`: beams are given from the
/// last one on.
lidar::Sweep timesOf(const RosLaserScan& scan, bool reversed);

/// The first echo of every beam.
RosLaserScan singleEcho(const RosMultiEchoLaserScan& multi);

/// Readings by REP 117 (ros.org/reps/rep-0117.html), written as lidar::toMrpt() writes them.
void setReadings(const RosLaserScan& scan, bool reversed, mrpt::obs::CObservation2DRangeScan& observation);

}  // namespace slam::bags
