#include "libslam/calibration/odometry_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>

#include "libslam/core/elementary.h"
#include "libslam/core/middle_value.h"

namespace slam::calibration {
namespace {

constexpr double kWindowPath_m = 0.5, kWindowTurn_rad = 0.5, kLongestWindow_s = 5;
constexpr double kLeastPath_m = 5, kLeastTurned_rad = 3;
constexpr double kConfidence = 1.96;  // 95 % of a normal distribution

/// One motion as both see it.
struct Window {
  core::Pose2 T_lidar, T_odometry;
};

/// Cuts a stretch into windows.
void addWindows(const Stretch& stretch, const std::string& stream, double offset_s,
                std::vector<Window>& windows) {
  const OdometryCurve odometry(stretch, stream);
  std::optional<core::Pose2> start;
  core::Pose2 T_lidar;
  double start_s = 0, path_m = 0, turned_rad = 0;
  for (const auto& step : stretch.steps) {
    const double duration_s = step.to_s - step.from_s;
    const auto here = odometry.at(step.to_s - offset_s);
    if (!step.is_reliable || !here || duration_s <= 0 || duration_s > kLongestWindow_s) {
      start.reset();
      continue;
    }
    if (!start) {
      start = odometry.at(step.from_s - offset_s);
      start_s = step.from_s;
      T_lidar = {};
      path_m = turned_rad = 0;
      if (!start) continue;
    }
    T_lidar = T_lidar * step.T_previous_lidar;
    path_m += core::hypot(step.T_previous_lidar.x, step.T_previous_lidar.y);
    turned_rad += std::abs(step.T_previous_lidar.phi);
    if (path_m < kWindowPath_m && turned_rad < kWindowTurn_rad && step.to_s - start_s < kLongestWindow_s)
      continue;
    windows.push_back({T_lidar, core::between(*start, *here)});
    start = here;
    start_s = step.to_s;
    T_lidar = {};
    path_m = turned_rad = 0;
  }
}

/// A robust linear fit and its covariance; rows come in groups that are right or wrong together.
struct Fit {
  Eigen::VectorXd x;
  Eigen::MatrixXd covariance;
  Estimate at(int i) const {
    const double half = kConfidence * std::sqrt(covariance(i, i));
    return {x[i], x[i] - half, x[i] + half};
  }
};

Eigen::MatrixXd pseudoInverse(const Eigen::MatrixXd& matrix) {
  return matrix.completeOrthogonalDecomposition().pseudoInverse();
}

/// Between two slices of how the scores change with the parameters the scores' own scatter. A score is weight
/// times residual, and the weight falls as the residual grows: how the score changes is less than the weight.
Eigen::MatrixXd sandwich(const Eigen::MatrixXd& A, const Eigen::VectorXd& residuals,
                         const Eigen::VectorXd& weights, int group, double far) {
  Eigen::MatrixXd slope = Eigen::MatrixXd::Zero(A.cols(), A.cols()), meat = slope;
  for (Eigen::Index row = 0; row < A.rows(); row += group) {
    const Eigen::MatrixXd part = A.middleRows(row, group);
    const Eigen::VectorXd r = residuals.segment(row, group);
    const double w = weights[row];
    const Eigen::MatrixXd change =
        w * Eigen::MatrixXd::Identity(group, group) - 2 * w * w / (far * far) * r * r.transpose();
    slope += part.transpose() * change * part;
    const Eigen::VectorXd score = w * part.transpose() * r;
    meat += score * score.transpose();
  }
  const Eigen::MatrixXd inverse = pseudoInverse(slope);
  return inverse * meat * inverse;
}

Fit robustFit(const Eigen::MatrixXd& A, const Eigen::VectorXd& b, int group, double least_scale) {
  constexpr int kIterations = 30;
  constexpr double kCauchy = 2.385;  // Holland and Welsch (1977): 95 % efficient under Gaussian noise
  const Eigen::Index groups = A.rows() / group;
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(A.rows());
  Fit fit;
  Eigen::VectorXd residuals;
  double far = 1;  // residuals of this size have half of the weight
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::MatrixXd weighted = weights.asDiagonal() * A;
    const Eigen::VectorXd x = pseudoInverse(A.transpose() * weighted) * (weighted.transpose() * b);
    const bool is_still = iteration > 0 && (x - fit.x).norm() < 1e-9;
    fit.x = x;
    residuals = A * x - b;
    if (is_still) break;
    std::vector<double> sizes;
    for (Eigen::Index g = 0; g < groups; ++g) sizes.push_back(residuals.segment(g * group, group).norm());
    // Median of the size to the deviation of one component: 0.6745 for one, 1.1774 for two (Rayleigh).
    const double scale = std::max(core::middleValue(sizes) / (group == 1 ? 0.6745 : 1.1774), least_scale);
    far = kCauchy * scale;
    for (Eigen::Index g = 0; g < groups; ++g) {
      const double u = sizes[static_cast<std::size_t>(g)] / far;
      weights.segment(g * group, group).setConstant(1 / (1 + u * u));
    }
  }
  fit.covariance = sandwich(A, residuals, weights, group, far);
  return fit;
}

Estimate dividedBy(const Estimate& estimate, double positive) {
  return {estimate.value / positive, estimate.low / positive, estimate.high / positive};
}

void fitTurns(const std::vector<Window>& windows, OdometryFit& result) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(windows.size()), 2);
  Eigen::VectorXd b(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    const auto& [lidar, odometry] = windows[static_cast<std::size_t>(i)];
    A(i, 0) = lidar.phi;
    A(i, 1) = core::hypot(lidar.x, lidar.y);
    b[i] = odometry.phi;
  }
  const auto fit = robustFit(A, b, 1, 1e-4);
  result.turn_scale = fit.at(0);
  result.drift_rad_per_m = fit.at(1);
}

void fitMoves(const std::vector<Window>& windows, OdometryFit& result) {
  Eigen::MatrixXd A(static_cast<Eigen::Index>(2 * windows.size()), 4);
  Eigen::VectorXd b(A.rows());
  for (std::size_t i = 0; i < windows.size(); ++i) {
    const auto& [lidar, odometry] = windows[i];
    const double c = core::cos(lidar.phi) - 1, s = core::sin(lidar.phi);
    const auto row = static_cast<Eigen::Index>(2 * i);
    A.row(row) << lidar.x, -lidar.y, -c, s;
    A.row(row + 1) << lidar.y, lidar.x, -s, -c;
    b[row] = odometry.x;
    b[row + 1] = odometry.y;
  }
  const auto fit = robustFit(A, b, 2, 1e-4);
  const double scale = core::hypot(fit.x[0], fit.x[1]);
  if (!(scale > 0)) return;
  // To first order about the scaled rotation: along it the scale, across it the yaw.
  const Eigen::Vector2d along = Eigen::Vector2d(fit.x[0], fit.x[1]) / scale, across(-along[1], along[0]);
  const Eigen::Matrix2d covariance = fit.covariance.topLeftCorner<2, 2>();
  const double half_scale = kConfidence * std::sqrt(along.dot(covariance * along));
  const double half_yaw = kConfidence * std::sqrt(across.dot(covariance * across)) / scale;
  const double yaw = core::atan2(fit.x[1], fit.x[0]);
  result.distance_scale = {scale, scale - half_scale, scale + half_scale};
  result.lidar_yaw_rad = {yaw, yaw - half_yaw, yaw + half_yaw};
  // The equation has them in the odometry's metres.
  result.lidar_x_m = dividedBy(fit.at(2), scale);
  result.lidar_y_m = dividedBy(fit.at(3), scale);
}

}  // namespace

OdometryFit fitOdometry(const std::vector<Stretch>& stretches, const std::string& stream, double offset_s) {
  OdometryFit result;
  std::vector<Window> windows;
  for (const auto& stretch : stretches) addWindows(stretch, stream, offset_s, windows);
  result.windows = windows.size();
  double seen_turn_rad = 0, seen_path_m = 0;
  for (const auto& window : windows) {
    result.path_m += core::hypot(window.T_odometry.x, window.T_odometry.y);
    result.turned_rad += std::abs(window.T_odometry.phi);
    seen_path_m += core::hypot(window.T_lidar.x, window.T_lidar.y);
    seen_turn_rad += std::abs(window.T_lidar.phi);
  }
  result.has_turns = seen_turn_rad >= kLeastTurned_rad && windows.size() >= 10;
  result.has_path = seen_path_m >= kLeastPath_m && windows.size() >= 10;
  result.has_position = result.has_turns;
  if (result.has_turns || result.has_path) {
    fitTurns(windows, result);
    fitMoves(windows, result);
  }
  return result;
}

}  // namespace slam::calibration
