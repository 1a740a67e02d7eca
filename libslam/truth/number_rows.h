#pragma once
#include <string>
#include <vector>

namespace slam::truth {

/// The rows of a CSV file of plain numbers under a known header; none where there is no such file. Errors:
/// InputError with file and line for another header, another number of fields, a field that is no number.
std::vector<std::vector<double>> readNumberRows(const std::string& path, const std::string& header);

}  // namespace slam::truth
