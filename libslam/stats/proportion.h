#pragma once
#include <cstddef>

#include "libslam/stats/estimate.h"

namespace slam::stats {

/// The exact two-sided interval of a rate of which `count` of `of` trials are known (Clopper and Pearson,
/// Biometrika 26(4), 1934): it covers the true rate at least as often as it says. 0 of n begins at 0, n of n
/// ends at 1, 0 of 0 is all of [0, 1]. REQUIRES count <= of, confidence in (0, 1) (ContractError).
Interval clopperPearson(std::size_t count, std::size_t of, double confidence = 0.95);

}  // namespace slam::stats
