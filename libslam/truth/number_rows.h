#pragma once
#include <string>
#include <vector>

namespace slam::truth {

/// The rows of a CSV file of plain numbers under a known header; none where there is no such file. Errors:
/// InputError with file and line for another header, another number of fields, a field that is no number.
std::vector<std::vector<double>> readNumberRows(const std::string& path, const std::string& header);

/// The file `ending` beside a log or its truth: "a/run.rawlog" or "a/run.gt.tum" and ".collisions.csv" give
/// "a/run.collisions.csv".
std::string besideLog(const std::string& log_or_truth_path, const std::string& ending);

}  // namespace slam::truth
