#include "libslam/stats/consistency.h"

#include <Eigen/Cholesky>
#include <boost/math/distributions/chi_squared.hpp>
#include <cmath>

#include "libslam/core/error.h"

namespace slam::stats {
namespace {

/// What a run adds to the three figures.
struct RunSums {
  double errors = 0, nees = 0, within50 = 0, within95 = 0;
};

Estimate pooled(const std::vector<RunSums>& runs, double RunSums::*part, double scale,
                const BootstrapOptions& options) {
  return bootstrapInterval(
      runs.size(),
      [&](const std::vector<std::size_t>& indices) {
        double sum = 0, errors = 0;
        for (const std::size_t i : indices) {
          sum += runs[i].*part;
          errors += runs[i].errors;
        }
        return sum / (scale * errors);
      },
      options);
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
                                       int degrees_of_freedom, const BootstrapOptions& options) {
  const double within50 = chiSquaredQuantile(0.5, degrees_of_freedom);
  const double within95 = chiSquaredQuantile(0.95, degrees_of_freedom);
  std::vector<RunSums> runs;
  Consistency result;
  for (const auto& run : nees_of_runs) {
    if (run.empty()) continue;
    RunSums sums;
    for (const double nees : run) {
      if (!(nees >= 0 && std::isfinite(nees)))
        throw core::ContractError("consistency: a NEES that is negative or not finite");
      sums.errors += 1;
      sums.nees += nees;
      sums.within50 += nees <= within50 ? 1 : 0;
      sums.within95 += nees <= within95 ? 1 : 0;
    }
    runs.push_back(sums);
    result.samples += run.size();
  }
  result.runs = runs.size();
  if (runs.empty()) return std::nullopt;
  result.anees = pooled(runs, &RunSums::nees, degrees_of_freedom, options);
  result.coverage50 = pooled(runs, &RunSums::within50, 1, options);
  result.coverage95 = pooled(runs, &RunSums::within95, 1, options);
  return result;
}

}  // namespace slam::stats
