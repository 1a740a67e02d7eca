#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/keyframes/matching.h"
#include "libslam/keyframes/search.h"
#include "libslam/tracking/tracker.h"

namespace slam::tracking {
namespace {

using core::Pose2;
using scanmatch::PatchPoint;

/// A start that explains so much of a scan is near enough; the two scans, which are dear, are not asked.
constexpr double kNearEnough = 0.9;
/// Where no odometry tells how far the robot went, it is looked for on a lattice of this pitch.
constexpr double kSlide_m = 0.2;
constexpr double kStartTurns_rad[] = {-0.15, -0.07, 0.07, 0.15};
/// Odometry's turn errs by so many of its standard deviations at most.
constexpr double kTurnedWrong = 4;
/// And how far it turned, up to this, as stamps of real logs tell little of how fast.
constexpr double kTurnAbout_rad = 1, kTurnAboutStep_rad = 0.07;

}  // namespace

/// The start that explains most of a scan, less what odometry holds against it; odometry's own unless it
/// explains more than that by kStartGain. Turned by a quarter a crossing looks much alike.
Tracker::Start Tracker::bestStart(const lidar::Scan& scan, const std::vector<PatchPoint>& points,
                                  const Expected& e) const {
  const double own =
      surfelScore(points, around_.maps().coarse, e.predicted, keyframes::kKernel, keyframes::kStride);
  Start best{e.predicted, kStartGain};
  double worth = -std::numeric_limits<double>::infinity();  // of the best start but odometry's own
  const auto consider = [&](const Pose2& candidate) {
    const double gain = surfelScore(points, around_.maps().coarse, candidate, keyframes::kKernel,
                                    keyframes::kStride, own + std::max(kStartGain, worth)) -
                        own;
    if (gain <= std::max(kStartGain, worth)) return;
    const double left = e.has_odometry ? gain - unlikely(candidate, e) / keyframes::kNatsPerScan : gain;
    if (left > worth) best = {candidate, gain}, worth = left;
  };
  consider(e.T_before * motion_.step());
  consider(e.backwards);
  if (by_wheels_) consider(e.by_wheels);
  const auto turned = [&](double turn) {
    consider({e.predicted.x, e.predicted.y, e.predicted.phi + turn});
    if (by_wheels_) consider({e.by_wheels.x, e.by_wheels.y, e.by_wheels.phi + turn});
  };
  for (const double turn : kStartTurns_rad) turned(turn);
  if (e.has_odometry) {
    // As far as wheels err that turn with the robot.
    const double most =
        std::min(kTurnedWrong * motion_.sigmaOfWheels_rad(e.step.T_previous_robot), kTurnAbout_rad);
    for (double turn = kStartTurns_rad[3] + kTurnAboutStep_rad; turn <= most; turn += kTurnAboutStep_rad)
      turned(-turn), turned(turn);
  }
  if (!e.has_odometry) turnAbout(e, consider);
  const bool from_scans =
      !e.has_odometry || (best.gain > options_->distrust_gain && own + best.gain < kNearEnough);
  const auto motion = from_scans ? motion_.fromScans(scan) : std::nullopt;
  if (motion) consider(e.T_before * *motion);
  if (!e.has_odometry) slide(e, motion.value_or(core::between(e.T_before, best.T_map_robot)), consider);
  return best;
}

/// Every turn within reach where nothing tells it, on the spot and where the last motion leads.
void Tracker::turnAbout(const Expected& e, const Consider& consider) const {
  const int steps = static_cast<int>(kTurnAbout_rad / kTurnAboutStep_rad);
  for (int turn = -steps; turn <= steps; ++turn) {
    const double phi = e.T_before.phi + kTurnAboutStep_rad * turn;
    consider({e.T_before.x, e.T_before.y, phi});
    consider({e.predicted.x, e.predicted.y, phi});
  }
}

/// Two scans along a corridor look like one: they do not tell how far the robot went, but the map may. Every
/// place within reach, with the headings that the last motion and the two scans have, or else the best start
/// so far.
void Tracker::slide(const Expected& e, const Pose2& motion, const Consider& consider) const {
  const int steps = static_cast<int>(motion_.farthestMove() / kSlide_m);
  for (int x = -steps; x <= steps; ++x)
    for (int y = -steps; y <= steps; ++y)
      for (const double phi : {e.predicted.phi, e.T_before.phi + motion.phi})
        consider({e.T_before.x + kSlide_m * x, e.T_before.y + kSlide_m * y, phi});
}

}  // namespace slam::tracking
