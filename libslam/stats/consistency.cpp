#include "libslam/stats/consistency.h"

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>
#include <limits>
#include <numeric>

#include "libslam/core/error.h"
#include "libslam/stats/mean_interval.h"

namespace slam::stats {
namespace {

/// Of each run, what it adds to the figures.
struct Sums {
  std::vector<double> errors, finite, nees, within50, within95;
};

Estimate ofRuns(const std::vector<double>& parts, const std::vector<double>& wholes, double highest) {
  MeanOptions options;
  options.lowest = 0;
  options.highest = highest;
  return ratioInterval(parts, wholes, options);
}

void add(const std::vector<double>& run, double within50, double within95, Sums& sums) {
  double finite = 0, nees_sum = 0, within_50 = 0, within_95 = 0;
  for (const double nees : run) {
    if (!(nees >= 0)) throw core::ContractError("consistency: a NEES that is negative or no number");
    if (std::isfinite(nees)) finite += 1, nees_sum += nees;
    within_50 += nees <= within50 ? 1 : 0;
    within_95 += nees <= within95 ? 1 : 0;
  }
  sums.errors.push_back(static_cast<double>(run.size()));
  sums.finite.push_back(finite);
  sums.nees.push_back(nees_sum);
  sums.within50.push_back(within_50);
  sums.within95.push_back(within_95);
}

}  // namespace

std::optional<double> normalizedErrorSquared(const Eigen::VectorXd& error,
                                             const Eigen::MatrixXd& covariance) {
  if (error.size() == 0 || covariance.rows() != error.size() || covariance.cols() != error.size())
    throw core::ContractError("normalizedErrorSquared: the covariance is not of the error's size");
  if (!error.allFinite() || !covariance.allFinite()) return std::nullopt;
  // Metres and radians differ by orders of magnitude: only correlations say whether a covariance is singular.
  const Eigen::VectorXd sigmas = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  if (!(sigmas.minCoeff() > 0)) return std::nullopt;
  const Eigen::VectorXd inverse_sigmas = sigmas.cwiseInverse();
  const Eigen::MatrixXd correlation = inverse_sigmas.asDiagonal() * covariance * inverse_sigmas.asDiagonal();
  const Eigen::LLT<Eigen::MatrixXd> factor(correlation);
  constexpr double kSmallestPivot = 1e-7;  // squared, some hundred times the rounding of a double
  if (factor.info() != Eigen::Success || factor.matrixLLT().diagonal().minCoeff() < kSmallestPivot)
    return std::nullopt;
  const Eigen::VectorXd whitened = factor.matrixL().solve(inverse_sigmas.cwiseProduct(error));
  const double result = whitened.squaredNorm();
  if (!std::isfinite(result)) return std::nullopt;
  return result;
}

double chiSquaredQuantile(double probability, int degrees_of_freedom) {
  if (!(probability >= 0 && probability < 1))
    throw core::ContractError("chiSquaredQuantile: the probability must lie in [0, 1)");
  if (degrees_of_freedom < 1) throw core::ContractError("chiSquaredQuantile: at least one degree of freedom");
  return boost::math::quantile(boost::math::chi_squared(degrees_of_freedom), probability);
}

std::optional<Consistency> consistency(const std::vector<std::vector<double>>& nees_of_runs,
                                       int degrees_of_freedom) {
  const double within50 = chiSquaredQuantile(0.5, degrees_of_freedom);
  const double within95 = chiSquaredQuantile(0.95, degrees_of_freedom);
  Sums sums;
  Consistency result;
  for (const auto& run : nees_of_runs) {
    if (run.empty()) continue;
    add(run, within50, within95, sums);
    result.samples += run.size();
  }
  result.runs = sums.errors.size();
  if (result.runs == 0) return std::nullopt;
  const double finite = std::accumulate(sums.finite.begin(), sums.finite.end(), 0.0);
  result.singular_share = 1 - finite / static_cast<double>(result.samples);
  result.anees.value = std::numeric_limits<double>::quiet_NaN();
  if (finite > 0) {
    for (double& nees : sums.nees) nees /= degrees_of_freedom;
    result.anees = ofRuns(sums.nees, sums.finite, std::numeric_limits<double>::infinity());
  }
  result.coverage50 = ofRuns(sums.within50, sums.errors, 1);
  result.coverage95 = ofRuns(sums.within95, sums.errors, 1);
  return result;
}

}  // namespace slam::stats
