#include "libslam/keyframes/search.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_set>

#include "libslam/core/plane_cell.h"

namespace slam::keyframes {
namespace {

using core::Point2;
using core::Pose2;
using scanmatch::PatchPoint;

/// A map that has a twin of a place within itself may have one beyond its edge, too, where the robot may be:
/// by so much of its way at least, in metres, a part must fit one place better than every other.
constexpr double kAlone_m = 3;
/// Less is what wrong places of furnished rooms reach (0.6 to 0.7 of the right one's score), not rooms that
/// look the same (0.7 to 0.9): in a dozen drives of benchmarks/kidnapped, seeds 1000 to 1046.
constexpr double kLeastTwin = 0.7;

}  // namespace

double twinShare(double fits_m) {
  return std::max(kLeastTwin, 1 - kAlone_m / fits_m);
}

scanmatch::PosePrior followedTo(const Pose2& T_map_robot) {
  scanmatch::PosePrior prior;
  prior.mean = T_map_robot;
  prior.information.diagonal() << 100, 100, 1000;
  return prior;
}

bool isFollowed(const Pose2& T_map_matched, const Pose2& T_map_expected) {
  return core::distance(T_map_matched, T_map_expected) <= kConfirmStep_m &&
         std::abs(core::angleDifference(T_map_matched.phi, T_map_expected.phi)) <= kConfirmTurn_rad;
}

std::vector<Point2> searchPoints(const std::vector<PatchPoint>& points, size_t most) {
  const auto kept = thinned(points, kQuerySpacing_m);
  std::vector<Point2> result;
  const size_t count = std::min(most, kept.size());
  for (size_t i = 0; i < count; ++i) result.push_back(position(kept[i * kept.size() / count]));
  return result;
}

std::vector<PatchPoint> thinned(const std::vector<PatchPoint>& points, double side_m) {
  std::unordered_set<core::PlaneCell> taken;
  std::vector<PatchPoint> kept;
  for (const auto& p : points)
    if (taken.insert(core::planeCell(position(p), side_m)).second) kept.push_back(p);
  return kept;
}

}  // namespace slam::keyframes
