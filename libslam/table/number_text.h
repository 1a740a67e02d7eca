#pragma once
#include <string>

namespace slam::table {

/// A number as it stands in a table's cell: "-" for NaN, "inf", and no "-0.00".
std::string fixed(double value, int decimals);

}  // namespace slam::table
