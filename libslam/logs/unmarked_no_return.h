#pragma once
// For the .cpp files of this room only: beams that met nothing, which a log gives as distances.
#include <optional>
#include <string>
#include <vector>

#include "libslam/lidar/scan.h"
#include "libslam/logs/lidar_choice.h"

namespace slam::logs {

/// What a lidar says where it meets nothing, as far as its log gives that for a distance: m. The largest of
/// its readings, to the last bit, in one of a hundred readings at least, spread over a tenth of the beams,
/// and ten times as often as any other distance beyond four fifths of it. Noise never repeats like that; a
/// wall that a robot at rest looks at fills less of the view, or has neighbours in distance. Stricter than
/// calibration::RangeTally, which tells people of what may be one, by a whole log.
struct UnmarkedNoReturn {
  float reading_m;
  double share;  ///< of all readings
};
/// Nothing also where fewer than 20 scans are there to tell.
std::optional<UnmarkedNoReturn> unmarkedNoReturn(const std::vector<SeenScan>& seen, const std::string& label);
/// A line for people.
std::string sayUnmarked(const UnmarkedNoReturn& found, const std::string& label);
/// Makes no-returns of such readings; beyond them the lidar does not see.
void markNoReturns(lidar::Scan& scan, float reading_m);

}  // namespace slam::logs
