#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <vector>

#include "libslam/stats/estimate.h"

namespace slam::stats {

/// The normalised estimation error squared, error' covariance^-1 error (Bar-Shalom, Li and Kirubarajan,
/// Estimation with Applications to Tracking and Navigation, 2001, section 5.4): chi-squared with as many
/// degrees of freedom as the error has rows, if the covariance is true. nullopt where the covariance is not
/// positive definite to rounding (a pose that is given claims no error) or anything is not finite. REQUIRES a
/// square covariance of the error's size, above 0 (ContractError).
std::optional<double> normalizedErrorSquared(const Eigen::VectorXd& error, const Eigen::MatrixXd& covariance);

/// The value below which a chi-squared variable lies with the given probability. REQUIRES probability in [0,
/// 1), degrees_of_freedom at least 1 (ContractError).
double chiSquaredQuantile(double probability, int degrees_of_freedom);

/// Whether stated covariances are consistent with the errors. Every figure's interval is over runs
/// (ratioInterval()).
struct Consistency {
  /// Mean NEES over degrees of freedom: 1 is consistent, above 1 overconfident, below 1 conservative. Of the
  /// errors whose NEES is finite; NaN where none is.
  Estimate anees;
  double singular_share = 0;  ///< of the errors: NEES infinite, a covariance claimed a certainty that was not
  Estimate coverage50;        ///< share of errors within the ellipse that should hold half of them
  Estimate coverage95;
  std::size_t runs = 0, samples = 0;
};

/// From the NEES of every error, one list per run. Errors of one run depend on each other, so a run is one
/// unit; figures pool the errors of all runs, a long run counts more. Of one run: no intervals. Runs without
/// errors are left out; nullopt when no run has any. An infinite NEES, of an error that a singular covariance
/// excludes, lies outside of both ellipses. REQUIRES values of 0 or more, no NaN, and degrees_of_freedom of
/// at least 1 (ContractError).
std::optional<Consistency> consistency(const std::vector<std::vector<double>>& nees_of_runs,
                                       int degrees_of_freedom);

}  // namespace slam::stats
