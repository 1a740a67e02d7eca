#include "libslam/lidar/beam.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "libslam/core/elementary.h"

namespace slam::lidar {
namespace {

constexpr double kSmallestEdge_m = 0.1;
constexpr double kEdgePerMedianGap = 3;

using Ranges = std::vector<double>;

/// The first range beyond the edge; the end where there is none.
Ranges::const_iterator findEdge(const Ranges& sorted_m) {
  Ranges gaps_m(sorted_m.size());
  std::adjacent_difference(sorted_m.begin(), sorted_m.end(), gaps_m.begin());
  gaps_m.erase(gaps_m.begin());
  if (gaps_m.empty()) return sorted_m.end();
  Ranges ordered_m = gaps_m;
  std::sort(ordered_m.begin(), ordered_m.end());
  const double median_m = ordered_m[(ordered_m.size() - 1) / 2];
  const double edge_m = std::max(kSmallestEdge_m, kEdgePerMedianGap * median_m);
  const auto edge = std::find_if(gaps_m.begin(), gaps_m.end(), [&](double gap_m) { return gap_m > edge_m; });
  return edge == gaps_m.end() ? sorted_m.end() : sorted_m.begin() + (edge - gaps_m.begin()) + 1;
}

double mean(Ranges::const_iterator begin, Ranges::const_iterator end) {
  return std::accumulate(begin, end, 0.0) / static_cast<double>(end - begin);
}

}  // namespace

double rayOffset(const LidarOptions& options, int ray) {
  return options.beam_width_rad * (static_cast<double>(ray) / (kRaysPerBeam - 1) - 0.5);
}

double beamRange(Ranges ranges_m, bool mixes, double where) {
  ranges_m.erase(
      std::remove_if(ranges_m.begin(), ranges_m.end(), [](double range_m) { return std::isinf(range_m); }),
      ranges_m.end());
  if (ranges_m.empty()) return std::numeric_limits<double>::infinity();
  std::sort(ranges_m.begin(), ranges_m.end());
  const auto edge = findEdge(ranges_m);
  const double near_m = mean(ranges_m.begin(), edge);
  if (!mixes || edge == ranges_m.end()) return near_m;
  return near_m + where * (mean(edge, ranges_m.end()) - near_m);
}

double glassEcho(const LidarOptions& options, double incidence_rad) {
  const double steepness = incidence_rad / options.glass_echo_rad, halvings = steepness * steepness;
  return options.glass_echo * core::exp2(-halvings);
}

double glassReflectance(const LidarOptions& options, double incidence_rad) {
  if (options.glass_reflectance >= 1) return 1;
  const double face_head_on = options.glass_reflectance / (2 - options.glass_reflectance);
  const double index = (1 + std::sqrt(face_head_on)) / (1 - std::sqrt(face_head_on));
  const auto [sine, in] = core::sinCos(incidence_rad);
  const double out = std::sqrt(std::max(0.0, 1 - (sine / index) * (sine / index)));
  const double across = (in - index * out) / (in + index * out);
  const double along = (index * in - out) / (index * in + out);
  const double face = 0.5 * (across * across + along * along);
  return 2 * face / (1 + face);
}

}  // namespace slam::lidar
