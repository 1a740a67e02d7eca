#include "libslam/stats/proportion.h"

#include <boost/math/distributions/beta.hpp>
#include <string>

#include "libslam/core/error.h"

namespace slam::stats {

Interval clopperPearson(std::size_t count, std::size_t of, double confidence) {
  if (count > of)
    throw core::ContractError("clopperPearson: " + std::to_string(count) + " of " + std::to_string(of));
  if (!(confidence > 0 && confidence < 1))
    throw core::ContractError("clopperPearson: confidence must lie in (0, 1)");
  const double tail = (1 - confidence) / 2;
  const auto hits = static_cast<double>(count), misses = static_cast<double>(of - count);
  // The binomial's tails as quantiles of beta distributions.
  Interval interval{0, 1};
  if (count > 0)
    interval.low = boost::math::quantile(boost::math::beta_distribution<>(hits, misses + 1), tail);
  if (count < of)
    interval.high = boost::math::quantile(
        boost::math::complement(boost::math::beta_distribution<>(hits + 1, misses), tail));
  return interval;
}

}  // namespace slam::stats
