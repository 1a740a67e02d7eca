#include "libslam/odometry/planar_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace slam::odometry {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Basis = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>;

/// Holland and Welsch, "Robust regression using iteratively reweighted least-squares" (1977): this multiple
/// of the noise gives Cauchy's weights 95 % efficiency under Gaussian noise.
constexpr double kCauchy = 2.385;
constexpr double kMadToSigma = 1.4826;     // of a normal distribution
constexpr double kSmallestScale_m = 1e-3;  // keeps noise-free scans from dividing by zero
constexpr double kCostCut_m = 0.10;        // a residual of this size costs as much as no match
constexpr double kNormalAgreement = 0.7;   // cosine; surfaces turned more than 45 degrees are not the same
constexpr double kEndMargin_m = 0.05;      // a point may lie this far beyond the end of its line
constexpr double kStill_m = 1e-5, kStill_rad = 1e-6;  // far below any range noise
constexpr double kNarrowing = 0.7;                    // of the first scale and the gate, per iteration
/// Least share of the range noise that is believed to be left across a grazed line: walls are not ideal.
constexpr double kGrazing = 0.5;
constexpr double kCurved_rad = 0.02;  // error of a normal besides noise: bent walls, lines grown to one side
constexpr long kReach = 8;            // beams to each side in which a partner is looked for
constexpr double kSameSurface = 5;    // times the noise
constexpr int kFewestPairs = 6;
/// A direction counts as determined when at least this share of its information is not feigned.
constexpr double kGenuineShare = 0.3;
constexpr double kLargestStd = 0.05;  // metres (or radians): worse than this is no measurement

struct Pair {
  Vector3d jacobian;        // of the residual by (x, y, phi)
  Vector3d by_normal_turn;  // of the jacobian by the direction of the normal
  double residual_m;
  double normal_variance;  // rad^2 per m^2
};

struct Pairs {
  std::vector<Pair> matched;
  int compared = 0;
};

class Matcher {
 public:
  Matcher(const ScanLines& reference, const ScanLines& moving) : reference_(reference), moving_(moving) {}

  Pairs match(const core::Pose2& T, int stride, double gate_m) const {
    const double c = std::cos(T.phi), s = std::sin(T.phi);
    Pairs pairs;
    for (size_t i = 0; i < moving_.points.size(); i += static_cast<size_t>(stride)) {
      if (!moving_.is_return[i]) continue;
      const core::Point2& p = moving_.points[i];
      const core::Point2 arm{c * p.x - s * p.y, s * p.x + c * p.y};  // from the lidar, turned
      const core::Point2 q{T.x + arm.x, T.y + arm.y};
      const double range = std::sqrt(q.x * q.x + q.y * q.y);
      const double u = beamAt(q);
      if (!inView(u) || range <= 0) continue;
      ++pairs.compared;
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
      const double incidence = std::abs(line.normal.x * q.x + line.normal.y * q.y) / range;
      const double w = 1 / std::max(incidence, kGrazing);
      const core::Point2 swing{-arm.y, arm.x};
      const Vector3d jacobian(line.normal.x, line.normal.y,
                              line.normal.x * swing.x + line.normal.y * swing.y);
      const Vector3d by_normal_turn(-line.normal.y, line.normal.x,
                                    -line.normal.y * swing.x + line.normal.x * swing.y);
      pairs.matched.push_back({w * jacobian, w * by_normal_turn, w * residual, line.normal_variance_per_m2});
    }
    return pairs;
  }

 private:
  double beamAt(const core::Point2& q) const {
    double offset = std::atan2(q.y, q.x) - reference_.first_angle_rad;
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
    const long centre = std::lround(u);
    const long reach =
        std::clamp(static_cast<long>(std::ceil(gate_m / (range * reference_.step_rad))), 1L, kReach);
    constexpr double kFar = std::numeric_limits<double>::infinity();
    double least = kFar;
    long nearest = -1;
    for (long k = centre - reach; k <= centre + reach; ++k) {
      const long j = lineAt(k, own_normal);
      if (j < 0) continue;
      const core::Point2& r = reference_.points[static_cast<size_t>(j)];
      const double distance = (q.x - r.x) * (q.x - r.x) + (q.y - r.y) * (q.y - r.y);
      if (distance < least) nearest = j, least = distance;
    }
    if (nearest < 0) return -1;
    const core::Point2& normal = reference_.lines[static_cast<size_t>(nearest)].normal;
    const core::Point2& on = reference_.points[static_cast<size_t>(nearest)];
    long beside = nearest;
    least = kFar;
    for (long k = centre - reach; k <= centre + reach; ++k) {
      const long j = lineAt(k, own_normal);
      if (j < 0) continue;
      const core::Point2& r = reference_.points[static_cast<size_t>(j)];
      const double off = normal.x * (r.x - on.x) + normal.y * (r.y - on.y);
      const double along = std::abs(-normal.y * (q.x - r.x) + normal.x * (q.y - r.y));
      if (std::abs(off) < kSameSurface * reference_.sigma_m && along < least) beside = j, least = along;
    }
    return beside;
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
};

double robustScale(const std::vector<Pair>& pairs) {
  std::vector<double> size(pairs.size());
  std::transform(pairs.begin(), pairs.end(), size.begin(),
                 [](const Pair& p) { return std::abs(p.residual_m); });
  const auto middle = size.begin() + static_cast<long>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  return std::max(kMadToSigma * *middle, kSmallestScale_m);
}

/// The normal equations of the weighted fit.
struct Equations {
  Matrix3d information = Matrix3d::Zero();  // sum of w J J^T
  Matrix3d feigned = Matrix3d::Zero();      // what noise of the normals adds to it on average
  Vector3d gradient = Vector3d::Zero();
  int inliers = 0;
};

Equations normalEquations(const std::vector<Pair>& pairs, double scale_m, double noise_m) {
  Equations eq;
  const double c = kCauchy * scale_m;
  for (const Pair& p : pairs) {
    const double ratio = p.residual_m / c;
    const double w = 1 / (1 + ratio * ratio);
    eq.information += w * p.jacobian * p.jacobian.transpose();
    eq.gradient += w * p.residual_m * p.jacobian;
    const double normal_variance = p.normal_variance * noise_m * noise_m + kCurved_rad * kCurved_rad;
    eq.feigned += w * normal_variance * p.by_normal_turn * p.by_normal_turn.transpose();
    if (std::abs(ratio) < 1) ++eq.inliers;
  }
  return eq;
}

/// Genuine information along orthogonal directions, and those of them that have any.
struct Directions {
  Matrix3d axes;
  Vector3d genuine;
  Basis determined;
};

Directions analyse(const Equations& eq, double noise_m) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(eq.information - eq.feigned);
  Directions d{solver.eigenvectors(), solver.eigenvalues().cwiseMax(0.0), Basis(3, 0)};
  for (int k = 0; k < 3; ++k) {
    const Vector3d axis = d.axes.col(k);
    const double whole = axis.dot(eq.information * axis);
    const double weakest = 2 * noise_m * noise_m / (kLargestStd * kLargestStd);
    if (d.genuine[k] <= std::max(kGenuineShare * whole, weakest)) {
      d.genuine[k] = 0;
      continue;
    }
    d.determined.conservativeResize(3, d.determined.cols() + 1);
    d.determined.rightCols<1>() = axis;
  }
  return d;
}

/// The Gauss-Newton step within the determined directions (as Zhang, Kaess and Singh, "On degeneracy of
/// optimization-based state estimation problems", ICRA 2016).
Vector3d newtonStep(const Equations& eq, const Basis& basis) {
  if (basis.cols() == 0) return Vector3d::Zero();
  const Eigen::MatrixXd information = basis.transpose() * eq.information * basis;
  const Eigen::VectorXd gradient = basis.transpose() * eq.gradient;
  return -basis * information.ldlt().solve(gradient);
}

double meanCost(const Pairs& pairs) {
  double cost = 0;
  for (const Pair& p : pairs.matched)
    cost += std::min(1.0, p.residual_m * p.residual_m / (kCostCut_m * kCostCut_m));
  cost += static_cast<double>(pairs.compared) - static_cast<double>(pairs.matched.size());
  return pairs.compared > 0 ? cost / pairs.compared : 1;
}

void storeCovariance(const Matrix3d& covariance, std::array<double, 9>& out) {
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column)
      out[static_cast<size_t>(3 * row + column)] = (covariance(row, column) + covariance(column, row)) / 2;
}

}  // namespace

PlanarFit fitPlanarMotion(const ScanLines& reference, const ScanLines& moving, const core::Pose2& guess,
                          const PlanarFitOptions& options) {
  const Matcher matcher(reference, moving);
  const Vector3d prior(1 / (options.max_move_m * options.max_move_m),
                       1 / (options.max_move_m * options.max_move_m),
                       1 / (options.max_turn_rad * options.max_turn_rad));
  PlanarFit fit;
  fit.T_reference_moving = guess;
  fit.covariance = {1 / prior[0], 0, 0, 0, 1 / prior[1], 0, 0, 0, 1 / prior[2]};
  // The noise of the ranges themselves, not of the residuals: far from the solution those say nothing of it.
  const double range_noise = std::max(reference.sigma_m, moving.sigma_m);
  double gate = options.gate_m, widened = options.first_scale_m;
  for (int iteration = 0; iteration < options.max_iterations; ++iteration) {
    const Pairs pairs = matcher.match(fit.T_reference_moving, options.stride, gate);
    fit.compared = pairs.compared;
    fit.matched = static_cast<int>(pairs.matched.size());
    fit.cost = meanCost(pairs);
    if (fit.matched < kFewestPairs) return fit;
    const double noise = robustScale(pairs.matched);
    const double scale = std::max(noise, widened);
    const Equations eq = normalEquations(pairs.matched, scale, range_noise);
    fit.matched = eq.inliers;
    const Directions directions = analyse(eq, range_noise);
    fit.degenerate = directions.determined.cols() < 3;
    const Vector3d step = newtonStep(eq, directions.determined);
    Matrix3d information =
        directions.axes * (directions.genuine / (noise * noise)).asDiagonal() * directions.axes.transpose();
    information.diagonal() += prior;
    storeCovariance(information.inverse(), fit.covariance);
    fit.T_reference_moving.x += step[0];
    fit.T_reference_moving.y += step[1];
    fit.T_reference_moving.phi = core::wrapToPi(fit.T_reference_moving.phi + step[2]);
    gate = std::max({kNarrowing * gate, 6 * noise, 0.05});
    const bool narrow = widened <= noise;
    widened *= kNarrowing;
    if (narrow && std::abs(step[0]) + std::abs(step[1]) < kStill_m && std::abs(step[2]) < kStill_rad) break;
  }
  return fit;
}

}  // namespace slam::odometry
