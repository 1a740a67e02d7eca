#include "libslam/stats/seeds_needed.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>

#include "libslam/core/elementary.h"
#include "libslam/core/error.h"
#include "libslam/core/pose2.h"
#include "libslam/stats/mean_interval.h"
#include "libslam/stats/paired.h"

namespace slam::stats {
namespace {

constexpr double kMostSeeds = 1e6;

double standardDeviation(const std::vector<double>& values, double centre) {
  double squares = 0;
  for (const double value : values) squares += (value - centre) * (value - centre);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

}  // namespace

SeedsNeeded moreSeedsNeeded(const std::vector<double>& differences, double alpha, double power) {
  if (!(alpha > 0 && alpha < 1 && power > 0 && power < 1))
    throw core::ContractError("moreSeedsNeeded: alpha and power must lie in (0, 1)");
  using Answer = SeedsNeeded::Answer;
  const std::vector<double> zeros(differences.size());
  if (wilcoxonSignedRank(differences, zeros).p <= alpha) return {Answer::kEnough, 0};
  if (differences.size() < 2 ||
      std::any_of(differences.begin(), differences.end(), [](double d) { return std::isinf(d); }))
    return {Answer::kUnknown, 0};
  const double centre = mean(differences);
  if (centre == 0) return {Answer::kNoFiniteNumber, 0};

  constexpr double kEfficiency = 3 / core::kPi;
  const boost::math::normal normal;
  const double deviates = boost::math::quantile(normal, 1 - alpha / 2) + boost::math::quantile(normal, power);
  const double ratio = deviates * standardDeviation(differences, centre) / centre;
  const auto fewest = static_cast<double>(pairsNeeded(alpha));
  const double needed = std::max(fewest, std::ceil(ratio * ratio / kEfficiency));
  if (!(needed <= kMostSeeds)) return {Answer::kNoFiniteNumber, 0};
  // Unlucky so far: the spread promises enough, the test does not say so yet.
  const double more = std::max(1.0, needed - static_cast<double>(differences.size()));
  return {Answer::kMore, static_cast<std::size_t>(more)};
}

std::size_t pairsNeeded(double alpha) {
  if (!(alpha > 0 && alpha < 1)) throw core::ContractError("pairsNeeded: alpha must lie in (0, 1)");
  return static_cast<std::size_t>(std::ceil(1 - core::log2(alpha)));
}

}  // namespace slam::stats
