#include <algorithm>
#include <cmath>
#include <optional>

#include "libslam/core/elementary.h"
#include "libslam/odometry/local_lines.h"
#include "libslam/odometry/methods.h"
#include "libslam/odometry/planar_fit.h"
#include "libslam/odometry/profile_correlation.h"

namespace slam::odometry {
namespace {

constexpr size_t kCoarseBeams = 90;
constexpr int kCoarseIterations = 8;
constexpr int kFineIterations = 8;
constexpr double kFineScale_m = 0.02, kFineGate_m = 0.2;
constexpr size_t kCandidates = 3;
constexpr double kFewestMatched = 0.3;  // share of the compared returns
/// A fit from the predicted motion with at most this cost is not doubted.
constexpr double kConvincingCost = 0.25;

/// Point-to-line ICP from scan to scan (Censi, ICRA 2008), started from the motion of the step before. Where
/// that leads to a poor fit, the turns under which the range profiles look alike are tried too, and the best
/// fit counts. In a direction that the scans do not determine (along a corridor) the prediction stays.
///
/// Where we differ from the paper: the lines are fitted to all beams of one surface and not drawn through two
/// neighbouring points, whose noise would bias the motion towards zero; the trimming is soft, by Cauchy
/// weights inside a narrowing gate; and the steps are Gauss-Newton's.
class PlicpOdometry : public ScanOdometry {
 public:
  explicit PlicpOdometry(const ScanOdometryOptions& options) : options_(options) {}

  void reset() override { previous_.reset(), T_step_ = {}; }

  ScanMotion update(const lidar::Scan& scan, const Commanded&) override {
    requireUsable(scan);
    Frame current{scan, findLocalLines(scan)};
    const ScanMotion motion = previous_ ? estimate(*previous_, current) : noMotionYet();
    previous_ = std::move(current);
    return motion;
  }

 private:
  struct Frame {
    lidar::Scan scan;
    ScanLines lines;
  };

  ScanMotion estimate(const Frame& before, const Frame& after) {
    PlanarFit fit = predictedFit(before, after);
    if (!believable(fit) || fit.cost > kConvincingCost) fit = search(before, after, fit);
    if (believable(fit)) fit = fineFit(before, after, fit.T_reference_moving);
    if (!believable(fit)) {
      T_step_ = {};
      return unknownMotion(options_);
    }
    T_step_ = fit.T_reference_moving;
    ScanMotion motion = robotMotion(before.scan, after.scan, fit.T_reference_moving, fit.covariance);
    motion.reliable = !fit.degenerate && isMeasurement(fit.covariance);
    return motion;
  }

  /// The best fit from all likely turns and the one there is.
  PlanarFit search(const Frame& before, const Frame& after, const PlanarFit& predicted) const {
    PlanarFit best = predicted;
    for (const auto& peak : correlateProfiles(before.scan, after.scan, options_.max_turn_rad, kCandidates)) {
      const PlanarFit fit = coarseFit(before, after, {0, 0, peak.turn_rad});
      if (believable(fit) && (!believable(best) || fit.cost < best.cost)) best = fit;
    }
    return best;
  }

  /// Few beams and a fast descent, as the prediction is seldom off by more than a decimetre.
  PlanarFit predictedFit(const Frame& before, const Frame& after) const {
    PlanarFitOptions options = coarseOptions(after);
    options.first_scale_m = 0.1;
    options.gate_m = 0.5;
    options.narrowing = 0.5;
    options.still_m = 1e-3, options.still_rad = 3e-4;
    return fitPlanarMotion(before.lines, after.lines, T_step_, options);
  }

  PlanarFit coarseFit(const Frame& before, const Frame& after, const core::Pose2& guess) const {
    PlanarFitOptions options = coarseOptions(after);
    options.gate_m = std::max(0.5 * options_.max_move_m, 0.1);
    return fitPlanarMotion(before.lines, after.lines, guess, options);
  }

  PlanarFit fineFit(const Frame& before, const Frame& after, const core::Pose2& guess) const {
    PlanarFitOptions options = fitOptions();
    options.first_scale_m = kFineScale_m;
    options.gate_m = kFineGate_m;
    options.max_iterations = kFineIterations;
    options.narrowing = 0.5;
    options.still_m = 5e-4, options.still_rad = 2e-4;
    return fitPlanarMotion(before.lines, after.lines, guess, options);
  }

  PlanarFitOptions coarseOptions(const Frame& after) const {
    PlanarFitOptions options = fitOptions();
    options.stride = static_cast<int>(std::max<size_t>(1, after.lines.points.size() / kCoarseBeams));
    options.max_iterations = kCoarseIterations;
    return options;
  }

  PlanarFitOptions fitOptions() const {
    PlanarFitOptions options;
    options.max_move_m = options_.max_move_m;
    options.max_turn_rad = options_.max_turn_rad;
    return options;
  }

  bool believable(const PlanarFit& fit) const {
    const auto& T = fit.T_reference_moving;
    return fit.matched > 0 && fit.matched >= kFewestMatched * fit.compared &&
           core::hypot(T.x, T.y) <= options_.max_move_m && std::abs(T.phi) <= options_.max_turn_rad;
  }

  ScanOdometryOptions options_;
  std::optional<Frame> previous_;
  core::Pose2 T_step_;  // of the lidar, the newest
};

}  // namespace

std::unique_ptr<ScanOdometry> makePlicpOdometry(const ScanOdometryOptions& options) {
  return std::make_unique<PlicpOdometry>(options);
}

}  // namespace slam::odometry
