#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace slam::stats {

struct ExplainedVariance {
  double share =
      0;  ///< of the values' variance that lies between the groups, 0 to 1: the correlation ratio eta squared
  /// The same less what groups drawn by chance explain, (k - 1) (1 - share) / (n - k), never below 0: epsilon
  /// squared (Kelley, PNAS 21(9), 1935).
  double adjusted_share = 0;
  double p = 1;  ///< how often groups drawn by chance explain as much
};

/// How much of the values' spread their groups explain: groups[i] is the group of values[i]. p by permuting
/// the groups `permutations` times with the stream "explained variance" of `seed`, the data itself counted in
/// (Phipson and Smyth, Statistical Applications in Genetics and Molecular Biology 9(1), 2010). All values
/// equal, one group, or as many groups as values: nothing is explained, p = 1. REQUIRES equal lengths, finite
/// values (ContractError).
ExplainedVariance explainedVariance(const std::vector<double>& values, const std::vector<std::size_t>& groups,
                                    std::uint64_t seed = 1, int permutations = 2000);

}  // namespace slam::stats
