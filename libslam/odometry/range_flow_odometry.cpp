#include <algorithm>
#include <cmath>
#include <memory>

#include "libslam/core/elementary.h"
#include "libslam/odometry/methods.h"
#include "libslam/odometry/normal_equations.h"
#include "libslam/odometry/profile_correlation.h"
#include "libslam/odometry/range_flow_levels.h"

namespace slam::odometry {
namespace {

constexpr int kWarps = 2;         // at the finest level; one at the others
constexpr int kReweightings = 3;  // per warp
/// A scan serves as reference until the robot is this far from it.
constexpr double kReferenceReach_m = 0.4, kReferenceReach_rad = 15 * core::kPi / 180;
/// Scale of the weights at the coarsest level where the noise alone left a direction undetermined, and what
/// it narrows by from level to level. Along a corridor only a few beams tell the motion, and from a wrong
/// start they look like outliers among walls that fit anyhow; but a wide scale lets true outliers in as well,
/// so it is the second try and has to explain the ranges clearly better.
constexpr double kWideScale_m = 0.2, kNarrowing = 0.5, kClearlyBetter = 0.8;
constexpr double kGradientSpan_m = 0.2;  // to each side; a shorter one would differentiate noise
constexpr size_t kGradientReach = 8;     // beams
constexpr double kGrazing = 0.5;         // as for point-to-line residuals
constexpr double kStraight = 3;          // times the noise: a larger bend is a corner
constexpr int kFewestRows = 6;
constexpr double kCostCut_m = 0.10;       // a residual of this size costs as much as no overlap
constexpr double kConvincingCost = 0.25;  // a flow from the predicted motion with at most this is not doubted
constexpr double kFewestInliers = 0.3;    // share of the rows

/// One range flow constraint.
struct Row {
  double jacobian[3];    // of the residual by the velocity of the lidar, per scan
  double turn_by_slope;  // of jacobian[2] by the slope of the surface; the others are sin and -cos
  double sin, cos;
  double slope_variance;
  double residual_m;
};

/// Derivative of the inverse range by the angle at one beam: from the beams `reach` before and behind it, or
/// from one of them where the other is on another surface. Exact on straight walls: p(a + h) = p(a) cos h +
/// p'(a) sin h. False where neither side is there.
bool inverseGradient(const std::vector<double>& p, size_t i, size_t reach, double tolerance,
                     double straight_m, double cos_h, double sin_h, double& gradient, double& noise_gain) {
  const auto usable = [&](size_t k) {
    return p[k] != 0 && std::abs(p[k] - p[i]) < tolerance * std::min(p[i], p[k]);
  };
  const bool left = i >= reach && usable(i - reach), right = i + reach < p.size() && usable(i + reach);
  if (left && right) {
    // Over a corner there is no one gradient. The middle beam's departure from the wall through the others:
    const double departure = std::abs(p[i] - (p[i + reach] + p[i - reach]) / (2 * cos_h)) / (p[i] * p[i]);
    if (departure > straight_m) return false;
    gradient = (p[i + reach] - p[i - reach]) / (2 * sin_h);
    noise_gain = 0.5 / (sin_h * sin_h);
  } else if (right) {
    gradient = (p[i + reach] - p[i] * cos_h) / sin_h;
    noise_gain = 2 / (sin_h * sin_h);
  } else if (left) {
    gradient = (p[i] * cos_h - p[i - reach]) / sin_h;
    noise_gain = 2 / (sin_h * sin_h);
  }
  return left || right;
}

/// The constraints of one level. With R(t, angle) the range, r its mean over both scans, and g = R_angle / r,
/// a rigid scene seen from a lidar that moves by (vx, vy, w) has (Jaimez, Monroy and Gonzalez-Jimenez,
/// "Planar odometry from a radial laser scanner. A range flow-based approach", ICRA 2016, section III)
///   (cos + g sin) vx + (sin - g cos) vy - g r w + R_t = 0.
/// Rows are scaled to the distance across the surface, but not by more than at grazing incidence, where the
/// error of the gradient rules (the paper's pre-weighting serves the same end).
void constraints(const Level& reference, const std::vector<double>& warped, double sigma_m,
                 std::vector<Row>& rows, std::vector<double>& mean) {
  const size_t n = reference.size();
  rows.clear();
  mean.assign(n, 0.0);
  for (size_t i = 0; i < n; ++i)
    if (reference.inverse_range[i] != 0 && warped[i] != 0)
      mean[i] = (reference.inverse_range[i] + warped[i]) / 2;
  double cos_h[kGradientReach + 1], sin_h[kGradientReach + 1];
  for (size_t k = 1; k <= kGradientReach; ++k) {
    cos_h[k] = core::cos(static_cast<double>(k) * reference.step_rad);
    sin_h[k] = core::sin(static_cast<double>(k) * reference.step_rad);
  }
  for (size_t i = 0; i < n; ++i) {
    if (mean[i] == 0) continue;
    const double p = mean[i];
    const double beams = std::min(kGradientSpan_m * p / reference.step_rad, double(kGradientReach));
    const size_t reach = std::max<size_t>(static_cast<size_t>(beams), 1);
    double gradient = 0, gain = 0;
    const double tolerance = kSteepest * static_cast<double>(reach) * reference.step_rad + 4 * sigma_m * p;
    if (!inverseGradient(mean, i, reach, tolerance, kStraight * sigma_m, cos_h[reach], sin_h[reach], gradient,
                         gain))
      continue;
    const double r = 1 / p, g = -gradient * r;
    const core::Point2& d = reference.directions[i];
    const double incidence = 1 / std::sqrt(1 + g * g);
    const double w = incidence / std::max(incidence, kGrazing);
    // R_t from the difference of the inverse ranges about their mean, exact to first order.
    const double flow = (reference.inverse_range[i] - warped[i]) * r * r;
    rows.push_back({{w * (d.x + g * d.y), w * (d.y - g * d.x), -w * g * r},
                    -w * r,
                    w * d.y,
                    w * d.x,
                    gain * sigma_m * sigma_m * p * p / 2,
                    w * flow});
  }
}

/// How well the flow is explained in the end.
struct Flow {
  core::Pose2 T_reference_moving;
  std::array<double, 9> covariance{};
  int rows = 0, inliers = 0;
  double cost = 1;
  bool degenerate = true;
};

NormalEquations normalEquations(const std::vector<Row>& rows, const Eigen::Vector3d& velocity,
                                double scale_m) {
  OuterSum information, feigned;
  NormalEquations eq;
  eq.gradient.setZero();
  const double per_c = 1 / (kCauchy * scale_m);
  for (const Row& row : rows) {
    const double(&j)[3] = row.jacobian;
    const double left = row.residual_m + j[0] * velocity[0] + j[1] * velocity[1] + j[2] * velocity[2];
    const double ratio = left * per_c;
    const double w = 1 / (1 + ratio * ratio);
    information.add(w, j[0], j[1], j[2]);
    feigned.add(w * row.slope_variance, row.sin, -row.cos, row.turn_by_slope);
    const double wr = w * row.residual_m;
    eq.gradient += Eigen::Vector3d(wr * j[0], wr * j[1], wr * j[2]);
    if (std::abs(ratio) < 1) ++eq.inliers;
  }
  eq.information = information.matrix();
  eq.feigned = feigned.matrix();
  return eq;
}

class FlowSolver {
 public:
  FlowSolver(const Pyramid& reference, const Pyramid& moving, const ScanOdometryOptions& options)
      : reference_(reference), moving_(moving), options_(options) {}

  /// Coarse to fine from a guess.
  Flow solve(const core::Pose2& guess, double first_scale_m = 0) {
    Flow flow;
    flow.T_reference_moving = guess;
    const size_t levels = std::min(reference_.levels.size(), moving_.levels.size());
    double widened = first_scale_m;
    for (size_t k = levels; k-- > 0; widened *= kNarrowing)
      for (int i = 0; i < (k == 0 ? kWarps : 1); ++i)
        if (!refine(reference_.levels[k], moving_.levels[k], k == 0 ? 0 : widened, flow))
          return Flow{guess, {}, 0, 0, 1, true};
    return flow;
  }

 private:
  bool refine(const Level& reference, const Level& moving, double least_scale_m, Flow& flow) {
    const double sigma = std::max(reference_.sigma_m, moving_.sigma_m);
    warp(moving, flow.T_reference_moving, reference, sigma, warped_);
    constraints(reference, warped_, sigma, rows_, mean_);
    flow.rows = static_cast<int>(rows_.size());
    if (flow.rows < kFewestRows) return false;
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Directions directions;
    double noise = 0;
    for (int i = 0; i < kReweightings; ++i) {
      noise = residualScale(velocity);
      const NormalEquations eq = normalEquations(rows_, velocity, std::max(noise, least_scale_m));
      flow.inliers = eq.inliers;
      directions = analyse(eq, std::max(sigma, noise));
      velocity = newtonStep(eq, directions.determined);
    }
    flow.degenerate = directions.determined.cols() < 3;
    flow.covariance = motionCovariance(directions, noise, options_.max_move_m, options_.max_turn_rad);
    flow.cost = meanCost(velocity);
    flow.T_reference_moving =
        core::Pose2{velocity[0], velocity[1], core::wrapToPi(velocity[2])} * flow.T_reference_moving;
    return true;
  }

  double left(const Row& row, const Eigen::Vector3d& v) const {
    return row.residual_m + row.jacobian[0] * v[0] + row.jacobian[1] * v[1] + row.jacobian[2] * v[2];
  }

  double residualScale(const Eigen::Vector3d& velocity) {
    sizes_.clear();
    for (const Row& row : rows_) sizes_.push_back(std::abs(left(row, velocity)));
    return robustScale(sizes_);
  }

  double meanCost(const Eigen::Vector3d& velocity) const {
    double cost = 0;
    for (const Row& row : rows_) {
      const double residual = left(row, velocity);
      cost += std::min(1.0, residual * residual / (kCostCut_m * kCostCut_m));
    }
    return cost / static_cast<double>(rows_.size());
  }

  const Pyramid& reference_;
  const Pyramid& moving_;
  const ScanOdometryOptions& options_;
  std::vector<double> warped_, mean_, sizes_;
  std::vector<Row> rows_;
};

/// Range flow odometry (the paper above): constraints from the gradients of the ranges in angle and time,
/// Cauchy weights, coarse to fine with warping, and in weakly determined directions the velocity of the step
/// before (the paper blends by eigenvalue, here a direction is determined or not). Where we differ: inverse
/// ranges, whose differences are exact on walls; gradients over at least the span that noise leaves standing;
/// one reference scan for as long as the robot stays near it; and a large turn, which no flow can follow, is
/// first taken out by the correlation of the range profiles.
class RangeFlowOdometry : public ScanOdometry {
 public:
  explicit RangeFlowOdometry(const ScanOdometryOptions& options) : options_(options) {}

  void reset() override { reference_.reset(), previous_.reset(), T_step_ = {}; }

  ScanMotion update(const lidar::Scan& scan, const Commanded&) override {
    requireUsable(scan);
    auto current = std::make_shared<Frame>(Frame{scan, makePyramid(scan), {}, {}});
    const ScanMotion motion = previous_ || reference_ ? estimate(*current) : noMotionYet();
    previous_ = std::move(current);
    return motion;
  }

 private:
  struct Frame {
    lidar::Scan scan;
    Pyramid pyramid;
    core::Pose2 T_reference_frame;  // of the lidar
    std::array<double, 9> covariance{};
  };

  ScanMotion estimate(Frame& after) {
    // While the robot stays near the reference scan, all flow is against it, so that the errors of the steps
    // between do not add up.
    if (!reference_ || !near(*previous_)) takeReference();
    Flow flow = solve(*reference_, after, previous_->T_reference_frame * T_step_);
    if (previous_ != reference_ && (!believable(flow) || flow.degenerate || flow.cost > kConvincingCost)) {
      takeReference();
      flow = solve(*reference_, after, T_step_);
    }
    if (!believable(flow)) {
      T_step_ = {};
      reference_.reset();
      return unknownMotion(options_);
    }
    after.T_reference_frame = flow.T_reference_moving;
    after.covariance = flow.covariance;
    T_step_ = core::between(previous_->T_reference_frame, after.T_reference_frame);
    ScanMotion motion = robotMotion(previous_->scan, after.scan, T_step_, stepCovariance(after));
    motion.reliable = !flow.degenerate && flow.cost < 2 * kConvincingCost && isMeasurement(flow.covariance);
    return motion;
  }

  void takeReference() {
    reference_ = previous_;
    previous_->T_reference_frame = {};
    previous_->covariance = {};
  }

  static bool near(const Frame& frame) {
    const auto& T = frame.T_reference_frame;
    return core::hypot(T.x, T.y) < kReferenceReach_m && std::abs(T.phi) < kReferenceReach_rad;
  }

  /// Of the motion from the frame before, where both frames were measured against the reference.
  std::array<double, 9> stepCovariance(const Frame& after) const {
    const auto& P = previous_->T_reference_frame;
    const auto [s, c] = core::sinCos(P.phi);
    // T_step = P^-1 T: by T a rotation, by P minus that, and the heading of P swings the step.
    const double by_after[3][3] = {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
    const double by_before[3][3] = {{-c, -s, T_step_.y}, {s, -c, -T_step_.x}, {0, 0, -1}};
    std::array<double, 9> out{};
    for (size_t row = 0; row < 3; ++row)
      for (size_t column = 0; column < 3; ++column)
        for (size_t i = 0; i < 3; ++i)
          for (size_t k = 0; k < 3; ++k)
            out[3 * row + column] +=
                by_after[row][i] * after.covariance[3 * i + k] * by_after[column][k] +
                by_before[row][i] * previous_->covariance[3 * i + k] * by_before[column][k];
    // Symmetric but for rounding so far.
    out[3] = out[1], out[6] = out[2], out[7] = out[5];
    return out;
  }

  Flow solve(const Frame& before, const Frame& after, const core::Pose2& guess) const {
    FlowSolver solver(before.pyramid, after.pyramid, options_);
    Flow flow = solver.solve(guess);
    if (flow.degenerate) {
      const Flow wide = solver.solve(guess, kWideScale_m);
      if (believable(wide) && !wide.degenerate && wide.cost < kClearlyBetter * flow.cost) flow = wide;
    }
    if (!believable(flow) || flow.cost > kConvincingCost)
      for (const auto& peak : correlateProfiles(before.scan, after.scan, options_.max_turn_rad, 2)) {
        const Flow other = solver.solve({0, 0, peak.turn_rad});
        if (believable(other) && (!believable(flow) || other.cost < flow.cost)) flow = other;
      }
    return flow;
  }

  bool believable(const Flow& flow) const {
    const auto& T = flow.T_reference_moving;
    return flow.rows >= kFewestRows && flow.inliers >= kFewestInliers * flow.rows &&
           core::hypot(T.x, T.y) <= options_.max_move_m && std::abs(T.phi) <= options_.max_turn_rad;
  }

  ScanOdometryOptions options_;
  std::shared_ptr<Frame> reference_, previous_;
  core::Pose2 T_step_;  // of the lidar, the newest
};

}  // namespace

std::unique_ptr<ScanOdometry> makeRangeFlowOdometry(const ScanOdometryOptions& options) {
  return std::make_unique<RangeFlowOdometry>(options);
}

}  // namespace slam::odometry
