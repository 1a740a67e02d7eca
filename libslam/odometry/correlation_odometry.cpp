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

constexpr size_t kCandidates = 3;
constexpr size_t kCoarseBeams = 120;  // enough to tell candidates apart
constexpr int kCoarseIterations = 8;
constexpr int kFineIterations = 15;
constexpr double kFineScale_m = 0.05, kFineGate_m = 0.3;
constexpr double kLikelyTurn_rad = 0.05;  // about 3 degrees: nearer to this than to a candidate, try none
constexpr double kFewestMatched = 0.3;    // share of the compared returns
/// Two different turns that fit about equally well: neither can be trusted.
constexpr double kAmbiguousCost = 0.02, kSameTurn_rad = 0.05;

/// The improved method: the turn from the correlation of the range profiles, then a full planar motion fitted
/// to all beams, started from each of the best few turns; the best fit counts.
class CorrelationOdometry : public ScanOdometry {
 public:
  explicit CorrelationOdometry(const ScanOdometryOptions& options) : options_(options) {}

  void reset() override { previous_.reset(); }

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

  ScanMotion estimate(const Frame& before, const Frame& after) const {
    std::vector<PlanarFit> fits;
    for (const double turn : startingTurns(before.scan, after.scan)) {
      const PlanarFit fit = coarseFit(before, after, turn);
      if (believable(fit)) fits.push_back(fit);
    }
    if (fits.empty()) return unknownMotion(options_);
    std::stable_sort(fits.begin(), fits.end(),
                     [](const PlanarFit& a, const PlanarFit& b) { return a.cost < b.cost; });
    const PlanarFit fit = fineFit(before, after, fits[0].T_reference_moving);
    if (!believable(fit)) return unknownMotion(options_);
    ScanMotion motion = robotMotion(before.scan, after.scan, fit.T_reference_moving, fit.covariance);
    motion.reliable = !ambiguous(fits) && !fit.degenerate && isMeasurement(fit.covariance);
    return motion;
  }

  std::vector<double> startingTurns(const lidar::Scan& before, const lidar::Scan& after) const {
    std::vector<double> turns;
    for (const auto& peak : correlateProfiles(before, after, options_.max_turn_rad, kCandidates))
      turns.push_back(peak.turn_rad);
    // A robot that barely turns is the common case, and a round room has no peak at all.
    const bool near_zero =
        std::any_of(turns.begin(), turns.end(), [](double turn) { return std::abs(turn) < kLikelyTurn_rad; });
    if (!near_zero) turns.push_back(0);
    return turns;
  }

  PlanarFit coarseFit(const Frame& before, const Frame& after, double turn_rad) const {
    PlanarFitOptions options = fitOptions();
    options.stride = static_cast<int>(std::max<size_t>(1, after.lines.points.size() / kCoarseBeams));
    options.max_iterations = kCoarseIterations;
    options.gate_m = std::max(0.5 * options_.max_move_m, 0.1);
    return fitPlanarMotion(before.lines, after.lines, {0, 0, turn_rad}, options);
  }

  PlanarFit fineFit(const Frame& before, const Frame& after, const core::Pose2& guess) const {
    PlanarFitOptions options = fitOptions();
    options.first_scale_m = kFineScale_m;
    options.gate_m = kFineGate_m;
    options.max_iterations = kFineIterations;
    return fitPlanarMotion(before.lines, after.lines, guess, options);
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

  static bool ambiguous(const std::vector<PlanarFit>& fits) {
    return std::any_of(fits.begin() + 1, fits.end(), [&fits](const PlanarFit& other) {
      const double apart =
          core::angleDifference(other.T_reference_moving.phi, fits[0].T_reference_moving.phi);
      return std::abs(apart) > kSameTurn_rad && other.cost < fits[0].cost + kAmbiguousCost;
    });
  }

  ScanOdometryOptions options_;
  std::optional<Frame> previous_;
};

}  // namespace

std::unique_ptr<ScanOdometry> makeCorrelationOdometry(const ScanOdometryOptions& options) {
  return std::make_unique<CorrelationOdometry>(options);
}

}  // namespace slam::odometry
