#include <algorithm>
#include <cmath>
#include <cstddef>

#include "libslam/keyframes/matching.h"
#include "libslam/tracking/tracker.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using scanmatch::MatchResult;
using scanmatch::PatchPoint;
using scanmatch::PosePrior;

/// A match found so must explain this much more than the one before.
constexpr double kRecoverGain = 0.05;
/// The lattice of recover().
constexpr int kLatticeTurns = 10, kLatticeSteps = 4;
constexpr double kLatticeTurn_rad = 0.03, kLatticeStep_m = 0.1;
/// The lattice of placesWithinReach(), and how far from odometry's turn it reaches.
constexpr double kPitch_m = 0.2, kPitch_rad = 0.07, kMostTurn_rad = 1;
/// A place explains so much of a scan; so near to another it is the same one.
constexpr double kLeastOfPlace = 0.3, kOnePlace_m = 0.5, kOnePlace_rad = 0.25;
constexpr std::size_t kMostPlaces = 6;

/// Holds a match near its start, hardly.
PosePrior weakPrior(const Pose2& T_start) {
  PosePrior weak;
  weak.mean = T_start;
  weak.information.diagonal() << 10, 10, 10;
  return weak;
}

}  // namespace

/// The best pose on a lattice around the predicted one, refined without regard to odometry.
std::optional<MatchResult> Tracker::recover(const std::vector<PatchPoint>& points, const Pose2& predicted,
                                            const Pose2& matched) const {
  Pose2 best = matched;
  const double before = surfelScore(points, around_.maps().middle, matched, keyframes::kKernel, 2);
  double best_score = before;
  for (int turn = -kLatticeTurns; turn <= kLatticeTurns; ++turn)
    for (int x = -kLatticeSteps; x <= kLatticeSteps; ++x)
      for (int y = -kLatticeSteps; y <= kLatticeSteps; ++y) {
        const Pose2 candidate{predicted.x + kLatticeStep_m * x, predicted.y + kLatticeStep_m * y,
                              predicted.phi + kLatticeTurn_rad * turn};
        const double score =
            surfelScore(points, around_.maps().middle, candidate, keyframes::kKernel, 2, best_score);
        if (score > best_score) best_score = score, best = candidate;
      }
  if (!(best_score > before)) return std::nullopt;
  return keyframes::match(points, around_.maps(), best, weakPrior(best), 0, false);
}

/// Poses in which a robot may be whose wheels slipped since the scan before, and that explain much of a scan:
/// the best first, each far from the others.
std::vector<Pose2> Tracker::placesWithinReach(const std::vector<PatchPoint>& points,
                                              const Expected& e) const {
  struct Place {
    double score;
    Pose2 T_map_robot;
  };
  const int steps = static_cast<int>(motion_.farthestMove() / kPitch_m),
            turns = static_cast<int>(kMostTurn_rad / kPitch_rad);
  std::vector<Place> places;
  for (int turn = -turns; turn <= turns; ++turn)
    for (int x = -steps; x <= steps; ++x)
      for (int y = -steps; y <= steps; ++y) {
        const Pose2 T{e.T_before.x + kPitch_m * x, e.T_before.y + kPitch_m * y,
                      e.predicted.phi + kPitch_rad * turn};
        if (!motion_.isSlip(core::between(e.T_before, T), e.step)) continue;
        const double score = surfelScore(points, around_.maps().coarse, T, keyframes::kKernel,
                                         keyframes::kStride, kLeastOfPlace);
        if (score > kLeastOfPlace) places.push_back({score, T});
      }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.score > b.score; });
  std::vector<Pose2> best;
  for (const auto& place : places) {
    const bool is_new = std::none_of(best.begin(), best.end(), [&](const Pose2& T) {
      return core::distance(T, place.T_map_robot) < kOnePlace_m &&
             std::abs(core::angleDifference(T.phi, place.T_map_robot.phi)) < kOnePlace_rad;
    });
    if (is_new) best.push_back(place.T_map_robot);
    if (best.size() == kMostPlaces) break;
  }
  return best;
}

/// Looks for a better match of a scan that is poorly explained: close to where odometry has it, and, where
/// the scan before contradicts what is found, too, wherever a slip of the wheels may have left the robot.
/// Whether there was one.
bool Tracker::lookAround(const std::vector<PatchPoint>& points, const Expected& e, MatchResult& result) {
  bool is_found = false;
  const auto consider = [&](const MatchResult& other) {
    if (!isBetter(other, result, kRecoverGain, points, e)) return;
    result = other;
    is_found = true;
  };
  if (const auto other = recover(points, e.predicted, result.T_map_robot)) consider(*other);
  if (e.has_odometry && around_.isPoor(result, points) && brokenAt(result.T_map_robot, points, e) > kBroken)
    for (const Pose2& T : placesWithinReach(points, e)) {
      const auto other = keyframes::match(points, around_.maps(), T, weakPrior(T), 0, true);
      if (motion_.isSlip(core::between(e.T_before, other.T_map_robot), e.step)) consider(other);
    }
  if (is_found) map_->note(core::JournalEvent::kRematched, result.score);
  return is_found;
}

}  // namespace slam::tracking
