#pragma once
#include <vector>

namespace slam::stats {

/// p-values of several tests, each raised so that all of them together reject a true hypothesis with at most
/// the chance that each alone is allowed (Holm, Scandinavian Journal of Statistics 6(2), 1979): the k-th
/// smallest of m times m - k + 1, never below a smaller one's, at most 1. In the order given; of none, none.
/// REQUIRES each in [0, 1] (ContractError).
std::vector<double> holm(const std::vector<double>& p_values);

}  // namespace slam::stats
