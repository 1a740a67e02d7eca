#pragma once
#include <vector>

namespace slam::logs {

/// The middle one, the upper of two; of none 0. One of the values as it is, never between two.
double middleValue(std::vector<double> values);

}  // namespace slam::logs
