#include "libslam/logs/unmarked_no_return.h"

#include <algorithm>
#include <cstdio>

namespace slam::logs {
namespace {

constexpr int kFewestScans = 20;
constexpr double kLeastShare = 0.01, kLeastSpread = 0.1, kNear = 0.8;
constexpr std::size_t kMoreOften = 10;

/// How often the commonest of these readings is there.
std::size_t mostAlike(std::vector<float> readings) {
  std::sort(readings.begin(), readings.end());
  std::size_t most = 0;
  for (auto first = readings.begin(); first != readings.end();) {
    const auto last = std::upper_bound(first, readings.end(), *first);
    most = std::max(most, static_cast<std::size_t>(last - first));
    first = last;
  }
  return most;
}

}  // namespace

std::optional<UnmarkedNoReturn> unmarkedNoReturn(const std::vector<SeenScan>& seen,
                                                 const std::string& label) {
  int scans = 0;
  std::size_t readings = 0, beams = 0, count = 0, first_beam = 0, last_beam = 0;
  float largest_m = 0;
  for (const auto& [lidar_scan, tilt_rad] : seen) {
    if (lidar_scan->lidar != label) continue;
    const auto& ranges_m = lidar_scan->scan.ranges_m;
    ++scans, readings += ranges_m.size(), beams = std::max(beams, ranges_m.size());
    for (std::size_t i = 0; i < ranges_m.size(); ++i) {
      if (!lidar::isReturn(ranges_m[i]) || ranges_m[i] < largest_m) continue;
      if (ranges_m[i] > largest_m) largest_m = ranges_m[i], count = 0, first_beam = last_beam = i;
      ++count, first_beam = std::min(first_beam, i), last_beam = std::max(last_beam, i);
    }
  }
  const double share = readings > 0 ? static_cast<double>(count) / static_cast<double>(readings) : 0;
  const auto spread = static_cast<double>(last_beam - first_beam);
  if (scans < kFewestScans || share < kLeastShare || spread < kLeastSpread * static_cast<double>(beams))
    return std::nullopt;
  std::vector<float> others;
  for (const auto& [lidar_scan, tilt_rad] : seen) {
    if (lidar_scan->lidar != label) continue;
    for (const float range_m : lidar_scan->scan.ranges_m)
      if (lidar::isReturn(range_m) && range_m < largest_m && range_m >= kNear * largest_m)
        others.push_back(range_m);
  }
  if (count < kMoreOften * mostAlike(std::move(others))) return std::nullopt;
  return UnmarkedNoReturn{largest_m, share};
}

std::string sayUnmarked(const UnmarkedNoReturn& found, const std::string& label) {
  char text[300];
  std::snprintf(text, sizeof text,
                "lidar '%s': %.1f %% of the first readings are %.6g m to the last bit, and none is larger: "
                "they are taken for beams that met nothing",
                label.c_str(), 100 * found.share, static_cast<double>(found.reading_m));
  return text;
}

void markNoReturns(lidar::Scan& scan, float reading_m) {
  for (float& range_m : scan.ranges_m)
    if (lidar::isReturn(range_m) && range_m >= reading_m) range_m = lidar::kNoReturn;
  scan.max_range_m = std::min(scan.max_range_m, static_cast<double>(reading_m));
}

}  // namespace slam::logs
