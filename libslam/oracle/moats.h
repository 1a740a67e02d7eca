#pragma once
#include <cstddef>
#include <vector>

namespace slam::oracle {

/// Groups of things to see, and how far apart they are.
struct Places {
  std::vector<double> area;                  ///< per group
  std::vector<double> from_start;            ///< per group
  std::vector<std::vector<double>> between;  ///< symmetric
};

/// The largest bound that the argument of boundBelow(), step 3, gives for a path from the start that misses
/// at most `spare` of the area, over a ladder of lambdas. At least 0. Cost: cubic in the groups.
double moatBound(const Places& places, double spare);

}  // namespace slam::oracle
