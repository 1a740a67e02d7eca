#pragma once
#include <limits>

namespace slam::core {

/// No value: not known, not measured, not defined. Equal to nothing, itself included.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
/// Without a bound.
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

}  // namespace slam::core
