#include "libslam/odometry/planar_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libslam/core/elementary.h"
#include "libslam/odometry/normal_equations.h"

namespace slam::odometry {
namespace {

using Eigen::Vector3d;

constexpr double kCostCut_m = 0.10;       // a residual of this size costs as much as no match
constexpr double kNormalAgreement = 0.7;  // cosine; surfaces turned more than 45 degrees are not the same
constexpr double kEndMargin_m = 0.05;     // a point may lie this far beyond the end of its line
/// Least share of the range noise that is believed to be left across a grazed line: walls are not ideal.
constexpr double kGrazing = 0.5;
constexpr double kCurved_rad = 0.02;  // error of a normal besides noise: bent walls, lines grown to one side
constexpr double kChord = 0.9;        // least chord over angle, up to 8 beams of 5 degrees
constexpr long kReach = 8;            // beams to each side in which a partner is looked for
constexpr double kSameSurface = 5;    // times the noise
constexpr int kFewestPairs = 6;
struct Pair {
  double jacobian[3];          // of the residual by (x, y, phi)
  double turn_by_normal_turn;  // of jacobian[2] by the direction of the normal; the others are -j[1] and j[0]
  double residual_m;
  double normal_variance;  // rad^2 per m^2
};

struct Pairs {
  std::vector<Pair> matched;
  int compared = 0;
};

class Matcher {
 public:
  Matcher(const ScanLines& reference, const ScanLines& moving) : reference_(reference), moving_(moving) {
    pairs_.matched.reserve(moving.points.size());
  }

  const Pairs& match(const core::Pose2& T, int stride, double gate_m) {
    const auto [s, c] = core::sinCos(T.phi);
    pairs_.matched.clear();
    pairs_.compared = 0;
    for (size_t i = 0; i < moving_.points.size(); i += static_cast<size_t>(stride)) {
      if (!moving_.is_return[i]) continue;
      const core::Point2& p = moving_.points[i];
      const core::Point2 arm{c * p.x - s * p.y, s * p.x + c * p.y};  // from the lidar, turned
      const core::Point2 q{T.x + arm.x, T.y + arm.y};
      const double range = std::sqrt(q.x * q.x + q.y * q.y);
      const double u =
          beamAt(moving_.first_angle_rad + static_cast<double>(i) * moving_.step_rad + T.phi, arm, q);
      if (!inView(u) || range <= 0) continue;
      ++pairs_.compared;
      const LocalLine& own = moving_.lines[i];
      const core::Point2 normal{c * own.normal.x - s * own.normal.y, s * own.normal.x + c * own.normal.y};
      const long j = partner(q, own.valid ? &normal : nullptr, u, range, gate_m);
      if (j < 0) continue;
      const LocalLine& line = reference_.lines[static_cast<size_t>(j)];
      const core::Point2& r = reference_.points[static_cast<size_t>(j)];
      const core::Point2 d{q.x - r.x, q.y - r.y};
      const double along = -line.normal.y * d.x + line.normal.x * d.y;
      if (along < line.low_m - kEndMargin_m || along > line.high_m + kEndMargin_m) continue;
      const double residual = line.normal.x * d.x + line.normal.y * d.y;
      if (std::abs(residual) > gate_m) continue;
      // Range noise acts along the beam; across the line only its share by the angle of incidence is seen.
      const double incidence = std::abs(line.normal.x * q.x + line.normal.y * q.y);
      const double w = range / std::max(incidence, kGrazing * range);
      const core::Point2 swing{-arm.y, arm.x};
      const double jx = w * line.normal.x, jy = w * line.normal.y;
      pairs_.matched.push_back({{jx, jy, jx * swing.x + jy * swing.y},
                                -jy * swing.x + jx * swing.y,
                                w * residual,
                                line.normal_variance_per_m2});
    }
    return pairs_;
  }

 private:
  /// The reference's beam, with its fraction, that points to q. The bearing of q differs from that of the
  /// turned arm by the parallax only, so a short series does for the arc tangent: wrong by less than 0.2 t^5,
  /// a hundredth of a degree at most, and only a search starts from it.
  double beamAt(double arm_angle, const core::Point2& arm, const core::Point2& q) const {
    const double across = arm.x * q.y - arm.y * q.x, ahead = arm.x * q.x + arm.y * q.y;
    const double t = across / ahead;
    const double parallax =
        ahead > 0 && std::abs(t) < 0.25 ? t * (1 - t * t / 3) : core::atan2(across, ahead);
    double offset = arm_angle + parallax - reference_.first_angle_rad;
    offset -= 2 * core::kPi * std::floor(offset / (2 * core::kPi));
    return offset / reference_.step_rad;
  }

  bool inView(double u) const {
    const double n = static_cast<double>(reference_.points.size());
    // The half beam before the first one wraps to the end of the circle.
    return reference_.full_circle || u <= n - 0.5 || u >= 2 * core::kPi / reference_.step_rad - 0.5;
  }

  /// The partner of a point: the return nearest to it tells the surface, and on that surface the return
  /// beside it along the wall is taken. Taking the nearest itself would pick, of all returns within the
  /// noise, the one with the most agreeable error.
  long partner(const core::Point2& q, const core::Point2* own_normal, double u, double range,
               double gate_m) const {
    // Whole beams below and above, and how far off the one above is; u is never negative.
    const long below = static_cast<long>(u);
    const double fraction = u - static_cast<double>(below), per_beam = kChord * range * reference_.step_rad;
    const double beams = std::min(gate_m / (range * reference_.step_rad), static_cast<double>(kReach));
    const long reach = std::clamp(static_cast<long>(beams) + 1, 1L, kReach);
    double least = std::numeric_limits<double>::infinity();
    long nearest = -1;
    // Outwards, as long as a beam may still hold something nearer than the nearest so far: beam k passes q
    // at no less than the chord of the angle between them (the early stop of Censi's search).
    for (long k = 0; k <= reach; ++k) {
      const double near = per_beam * (static_cast<double>(k) + std::min(fraction, 1 - fraction));
      if (near * near > least) break;
      for (const long beam : {below - k, below + 1 + k}) {
        const long j = lineAt(beam, own_normal);
        if (j < 0) continue;
        const core::Point2& r = reference_.points[static_cast<size_t>(j)];
        const double distance = (q.x - r.x) * (q.x - r.x) + (q.y - r.y) * (q.y - r.y);
        if (distance < least) nearest = beam, least = distance;
      }
    }
    if (nearest < 0) return -1;
    return beside(q, own_normal, nearest);
  }

  /// From a return walks along its surface while that leads nearer to the foot of q.
  long beside(const core::Point2& q, const core::Point2* own_normal, long nearest) const {
    const long start = lineAt(nearest, own_normal);
    const core::Point2& normal = reference_.lines[static_cast<size_t>(start)].normal;
    const core::Point2& on = reference_.points[static_cast<size_t>(start)];
    const auto along = [&](const core::Point2& r) {
      return std::abs(-normal.y * (q.x - r.x) + normal.x * (q.y - r.y));
    };
    const double same_surface = kSameSurface * reference_.sigma_m;
    long best = start;
    double least = along(on);
    for (const long way : {-1L, 1L}) {
      for (long k = 1; k <= kReach; ++k) {
        const long j = lineAt(nearest + way * k, own_normal);
        if (j < 0) continue;
        const core::Point2& r = reference_.points[static_cast<size_t>(j)];
        if (std::abs(normal.x * (r.x - on.x) + normal.y * (r.y - on.y)) >= same_surface) break;
        const double distance = along(r);
        if (distance >= least) break;
        best = j, least = distance;
      }
      if (best != start) break;
    }
    return best;
  }

  /// The beam, once round the circle where there is one; -1 where there is no beam, no line, or one that
  /// faces elsewhere than the point's own line (a door post is not matched with the wall that it stands in).
  long lineAt(long beam, const core::Point2* own_normal) const {
    const long n = static_cast<long>(reference_.points.size());
    if (beam < 0 || beam >= n) {
      if (!reference_.full_circle) return -1;
      beam = (beam % n + n) % n;
    }
    const LocalLine& line = reference_.lines[static_cast<size_t>(beam)];
    if (!line.valid) return -1;
    if (!own_normal) return beam;
    const double cosine = own_normal->x * line.normal.x + own_normal->y * line.normal.y;
    return std::abs(cosine) > kNormalAgreement ? beam : -1;
  }

  const ScanLines& reference_;
  const ScanLines& moving_;
  Pairs pairs_;
};

NormalEquations normalEquations(const std::vector<Pair>& pairs, double scale_m, double noise_m) {
  OuterSum information, feigned;
  double gx = 0, gy = 0, gz = 0;
  NormalEquations eq;
  const double per_c = 1 / (kCauchy * scale_m);
  for (const Pair& p : pairs) {
    const double ratio = p.residual_m * per_c;
    const double w = 1 / (1 + ratio * ratio);
    const double(&j)[3] = p.jacobian;
    information.add(w, j[0], j[1], j[2]);
    const double wr = w * p.residual_m;
    gx += wr * j[0], gy += wr * j[1], gz += wr * j[2];
    const double normal_variance = p.normal_variance * noise_m * noise_m + kCurved_rad * kCurved_rad;
    feigned.add(w * normal_variance, -j[1], j[0], p.turn_by_normal_turn);
    if (std::abs(ratio) < 1) ++eq.inliers;
  }
  eq.information = information.matrix();
  eq.feigned = feigned.matrix();
  eq.gradient = {gx, gy, gz};
  return eq;
}

double meanCost(const Pairs& pairs) {
  double cost = 0;
  for (const Pair& p : pairs.matched)
    cost += std::min(1.0, p.residual_m * p.residual_m / (kCostCut_m * kCostCut_m));
  cost += static_cast<double>(pairs.compared) - static_cast<double>(pairs.matched.size());
  return pairs.compared > 0 ? cost / pairs.compared : 1;
}

}  // namespace

PlanarFit fitPlanarMotion(const ScanLines& reference, const ScanLines& moving, const core::Pose2& guess,
                          const PlanarFitOptions& options) {
  Matcher matcher(reference, moving);
  std::vector<double> sizes;
  sizes.reserve(moving.points.size());
  PlanarFit fit;
  fit.T_reference_moving = guess;
  const double move = options.max_move_m * options.max_move_m;
  fit.covariance = {move, 0, 0, 0, move, 0, 0, 0, options.max_turn_rad * options.max_turn_rad};
  // The noise of the ranges themselves, not of the residuals: far from the solution those say nothing of it.
  const double range_noise = std::max(reference.sigma_m, moving.sigma_m);
  double gate = options.gate_m, widened = options.first_scale_m;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const Pairs& pairs = matcher.match(fit.T_reference_moving, options.stride, gate);
    fit.compared = pairs.compared;
    fit.matched = static_cast<int>(pairs.matched.size());
    fit.cost = meanCost(pairs);
    if (fit.matched < kFewestPairs) return fit;
    sizes.clear();
    for (const Pair& p : pairs.matched) sizes.push_back(std::abs(p.residual_m));
    const double noise = robustScale(sizes);
    const double scale = std::max(noise, widened);
    const NormalEquations eq = normalEquations(pairs.matched, scale, range_noise);
    fit.matched = eq.inliers;
    const Directions directions = analyse(eq, range_noise);
    fit.degenerate = directions.determined.cols() < 3;
    const Vector3d step = newtonStep(eq, directions.determined);
    fit.covariance = motionCovariance(directions, noise, options.max_move_m, options.max_turn_rad);
    fit.T_reference_moving.x += step[0];
    fit.T_reference_moving.y += step[1];
    fit.T_reference_moving.phi = core::wrapToPi(fit.T_reference_moving.phi + step[2]);
    gate = std::max({options.narrowing * gate, 6 * noise, 0.05});
    const bool narrow = widened <= noise;
    widened *= options.narrowing;
    if (narrow && std::abs(step[0]) + std::abs(step[1]) < options.still_m &&
        std::abs(step[2]) < options.still_rad)
      break;
  }
  return fit;
}

}  // namespace slam::odometry
